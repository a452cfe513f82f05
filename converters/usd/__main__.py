# SPDX-License-Identifier: MIT
"""How is the package run? As `python -m hemibake.usd`, or as this file by the program, which then needs neither the binding nor
what the binding imports: the folder itself is made a package of another name."""

import importlib.util
import os
import sys

if __package__:
    from .command import main
else:
    _here = os.path.dirname(os.path.abspath(__file__))
    sys.path[:] = [place for place in sys.path if place and os.path.abspath(place) != _here]
    sys.dont_write_bytecode = True
    _spec = importlib.util.spec_from_file_location("hemibake_usd", os.path.join(_here, "__init__.py"), submodule_search_locations=[_here])
    assert _spec and _spec.loader
    _package = importlib.util.module_from_spec(_spec)
    sys.modules["hemibake_usd"] = _package
    _spec.loader.exec_module(_package)
    from hemibake_usd.command import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
