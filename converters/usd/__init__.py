# SPDX-License-Identifier: MIT
"""USD in, USD out: a stage becomes one plain scene GLB that the program bakes, and the baked GLB becomes USD again.

    python -m hemibake.usd bake set.usda -o set.glb --quality draft      # the program, with this Python as its reader of USD
    python -m hemibake.usd scene set.usda -o scene.glb                   # only the GLB that is handed to the program
"""
