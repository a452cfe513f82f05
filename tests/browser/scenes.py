# SPDX-License-Identifier: MIT
"""Which surfaces are looked at, and which pixels does OpenColorIO say that they are?

    python3 scenes.py FOLDER CONFIG.ocio

Writes FOLDER/tiles.glb, a board of flat tiles that emit one colour each; FOLDER/room.glb, the room of the command's tests;
FOLDER/mixed.glb, the board with a sheet of glass that is not baked; and FOLDER/expected.json: where each tile is, and its
code values by OpenColorIO's own Python bindings, which share no line with the command.
"""

import json
import os
import sys

import PyOpenColorIO as ocio

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../cli"))
import gltf_file  # noqa: E402

COLUMNS, ROWS, SIZE, PITCH = 10, 8, 0.4, 0.5
DISTANCE, YFOV, WIDTH, HEIGHT = 6.0, 0.75, 640, 480
EXPOSURE_EV = 0.75

VIEWS = [["sRGB", "Soft"], ["sRGB", "Standard"], ["sRGB", "ACES 1.x SDR"], ["sRGB", "Filmic"], ["Display P3", "ACES 1.x SDR"]]


def colors():
    """A ramp of greys from ten stops under white to four above, then hues, pure and pale, dark and bright."""
    greys = [[2.0 ** (-10 + 14 * i / 19)] * 3 for i in range(20)]
    hues = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1), (1, 0.4, 0.1), (0.2, 0.5, 0.9), (0.6, 0.5, 0.4),
            (0.1, 0.3, 0.2)]
    scaled = [[level * (pale + (1 - pale) * x) for x in hue] for level, pale in
              ((0.02, 0), (0.18, 0), (0.18, 0.3), (0.7, 0.05), (1.0, 0), (6.0, 0.02)) for hue in hues]
    return greys + scaled


def tile(index):
    """A square of the board at z = 0, looking at +z, and its centre."""
    x = (index % COLUMNS - (COLUMNS - 1) / 2) * PITCH
    y = ((ROWS - 1) / 2 - index // COLUMNS) * PITCH
    h = SIZE / 2
    return ([[x - h, y - h, 0], [x + h, y - h, 0], [x + h, y + h, 0], [x - h, y + h, 0]], [(0, 1, 2), (0, 2, 3)]), (x, y)


def add_camera(scene, position, yfov):
    """Looking along -z."""
    scene.json["cameras"] = [{"type": "perspective",
                              "perspective": {"yfov": yfov, "aspectRatio": WIDTH / HEIGHT, "znear": 0.01, "zfar": 100}}]
    scene.json["nodes"].append({"name": "eye", "camera": 0, "translation": position})
    scene.json["scenes"][0]["nodes"].append(len(scene.json["nodes"]) - 1)


def board():
    scene = gltf_file.Scene()
    for index, color in enumerate(colors()):
        material = scene.add_material(f"colour {index}", (0, 0, 0), color)
        scene.add_mesh(f"tile {index}", tile(index)[0], material)
    add_camera(scene, [0, 0, DISTANCE], YFOV)
    return scene


def mixed():
    """The board, and a sheet of glass beside it that stays lit by the viewer."""
    scene = board()
    scene.json["materials"].append({"name": "glass", "alphaMode": "BLEND"})
    glass = [[2.6, -2, 0], [2.7, -2, 0], [2.7, 2, 0], [2.6, 2, 0]], [(0, 1, 2), (0, 2, 3)]
    scene.add_mesh("glass", glass, len(scene.json["materials"]) - 1)
    return scene


def room():
    """Seen through its front wall, whose back is culled."""
    scene = gltf_file.room()
    add_camera(scene, [0.3, 1.1, 3.4], 0.7)
    return scene


def expected(config, display, view):
    """Code values of each tile in [0,1]."""
    transform = ocio.DisplayViewTransform(src="Linear Rec.709", display=display, view=view)
    processor = config.getProcessor(transform).getDefaultCPUProcessor()
    scale = 2.0 ** EXPOSURE_EV
    return [[min(max(x, 0), 1) for x in processor.applyRGB([scale * c for c in color])] for color in colors()]


def main(folder, config_path):
    for name, scene in (("tiles", board()), ("mixed", mixed()), ("room", room())):
        with open(os.path.join(folder, name + ".glb"), "wb") as f:
            f.write(scene.glb())
    config = ocio.Config.CreateFromFile(config_path)
    facts = {
        "width": WIDTH, "height": HEIGHT, "distance": DISTANCE, "yfov": YFOV, "exposure_ev": EXPOSURE_EV, "size": SIZE,
        "centres": [tile(i)[1] for i in range(COLUMNS * ROWS)],
        "views": [{"display": d, "view": v, "codes": expected(config, d, v)} for d, v in VIEWS],
    }
    with open(os.path.join(folder, "expected.json"), "w", encoding="utf-8") as f:
        json.dump(facts, f)


if __name__ == "__main__":
    main(*sys.argv[1:])
