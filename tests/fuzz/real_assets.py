# SPDX-License-Identifier: MIT
"""Does any damage to a real asset crash or hang a bake, or end without a line that names file and place? Bytes, JSON and lengths are changed
at random, from a seed, and baked by the whole command.

    python3 tests/fuzz/real_assets.py [--count N] [--seed N] [--begin N] [FILE.glb ...]

By default of the samples, and the GLBs of ../shared/scenes and ../shared/field that are no larger than MIB_MOST. Prints a table; exit status 1
if one did not end as promised; such a file is kept, and named. --begin goes on where a run was stopped: each number is a damage of its own.
"""

import argparse
import collections
import glob
import json
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.insert(0, os.path.join(ROOT, "tests", "cli"))
import gltf_file  # noqa: E402
from hostile_test import damage_bytes, damage_json  # noqa: E402

HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
PROMISED, PATIENCE_S, MIB_MOST, NAME = (0, 1, 4), 120, 1.0, "scene.glb"
OPTIONS = ("-o", "out.glb", "--quality", "draft", "--max-elements", "20000", "--time", "1", "--quiet")
# A member of the JSON, a chunk, a byte, or what the whole file is or lacks.
PLACE = re.compile(r"^\w+(\.\w+)* is |\w+\[\d+\]|\b(node|mesh|material|image|texture|buffer|accessor|scene|primitive|camera|light) \d+|mesh ['\"]|material '|'\w+'|"
                   r"\bbytes?\b|line \d+|chunk|header|JSON|GLB|glTF|asset\.|it has no|it holds|its (scene|nodes)|extensionsRequired|there is no|there is nothing|"
                   r"the (scene|meshes|buffer|front of a surface)|elements|MiB")


def parts(data):
    """JSON and binary chunk of a GLB."""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length]), data[28 + length:]


def damage(data, dice):
    how = dice.random()
    if how < 0.5:
        tree, binary = parts(data)
        for _ in range(dice.choice((1, 1, 2, 5))):
            tree = damage_json(tree, dice)
            if not isinstance(tree, dict) or not tree:
                break
        return gltf_file.glb(tree, binary)
    if how < 0.9:
        return damage_bytes(data, dice)
    if how < 0.95:
        return data[:dice.randrange(len(data))]
    at = dice.choice((4, 8, 12, 16))
    return data[:at] + struct.pack("<I", dice.choice((0, 1, 3, len(data), 2**31, 2**32 - 1, dice.randrange(2**32)))) + data[at + 4:]


def survive(folder):
    """What is wrong with how it ended, or None; and its status."""
    try:
        ran = subprocess.run([HEMIBAKE, "bake", NAME, *OPTIONS], cwd=folder, capture_output=True, text=True, errors="replace", timeout=PATIENCE_S, check=False)
    except subprocess.TimeoutExpired:
        return "hang", "late"
    said, left = ran.stderr.strip(), sorted(os.listdir(folder))
    if ran.returncode not in PROMISED or "Sanitizer" in said:
        return f"crash or status: {ran.returncode}: {said[-200:]}", ran.returncode
    if left != ([NAME] if ran.returncode == 1 else ["out.glb", NAME]):
        return f"left: {left} after status {ran.returncode}", ran.returncode
    if ran.returncode == 1 and (not re.fullmatch(rf"hemibake: {re.escape(NAME)}: [^\n]+", said) or not PLACE.search(said.split(": ", 2)[2])):
        return f"no file and place: {said[-300:]}", 1
    return None, ran.returncode


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1989)
    parser.add_argument("--begin", type=int, default=0)
    parser.add_argument("files", nargs="*")
    asked = parser.parse_args()
    found = [os.path.join(ROOT, "samples", "**", "*.glb")] + [os.path.join(ROOT, "..", "shared", f, "*.glb") for f in ("scenes", "field")]
    paths = asked.files or [p for pattern in found for p in sorted(glob.glob(pattern, recursive=True)) if os.path.getsize(p) <= MIB_MOST * 2**20]
    wholes = []
    for path in paths:
        with open(path, "rb") as f:
            wholes.append(f.read())
    ended, wrong = collections.Counter(), collections.Counter()
    for number in range(asked.begin, asked.begin + asked.count):
        dice = random.Random(f"{asked.seed} {number}")
        data = damage(dice.choice(wholes), dice)
        folder = tempfile.mkdtemp(prefix="hemibake assets ")
        with open(os.path.join(folder, NAME), "wb") as f:
            f.write(data)
        fault, status = survive(folder)
        ended[status] += 1
        if fault:
            kept = os.path.join(tempfile.gettempdir(), f"asset-{asked.seed}-{number}.glb")
            shutil.move(os.path.join(folder, NAME), kept)
            wrong[fault.split(":")[0]] += 1
            print(f"{kept}: {fault}", flush=True)
        shutil.rmtree(folder)
    print(f"{asked.count} damages of {len(paths)} assets: " + ", ".join(f"{n} ended with {status}" for status, n in sorted(ended.items(), key=str)) +
          "; not as promised: " + (", ".join(f"{n} {what}" for what, n in sorted(wrong.items())) or "none"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
