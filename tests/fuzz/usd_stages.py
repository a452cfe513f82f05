# SPDX-License-Identifier: MIT
"""Does any damage to a USD stage crash or hang its reader? Words and numbers of stages are changed at random, from a seed, and baked.

    python3 tests/fuzz/usd_stages.py [--count N] [--seed N] [STAGE.usda ...]     by default the cases of ../shared/usd, else a small one

Each must end within its time as a bake, or in one line and a promised status. Prints a table; exit status 1 if one did not, 77 without pxr.
"""

import argparse
import collections
import glob
import os
import random
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
PROMISED, PATIENCE_S = (0, 1, 4), 60

STAGE = """#usda 1.0
( metersPerUnit = 1
  upAxis = "Y" )
def Xform "World" {
    def Mesh "floor" {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
        color3f[] primvars:displayColor = [(0.5, 0.5, 0.5)]
        uniform token subdivisionScheme = "none"
        double3 xformOp:translate = (0, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def RectLight "lamp" {
        float inputs:intensity = 5
        float inputs:width = 1
        float inputs:height = 1
    }
}
"""

ODD = ("-1", "0", "1", "2147483648", "1e308", "-1e308", "nan", "inf", '""', '"x"', "None", "[]", "()", "(0, 0)", "true", "@missing.usda@", "</World>", "\x00", "\u202e")


def damage(text, dice):
    for _ in range(dice.choice((1, 1, 2, 6))):
        words = list(re.finditer(r"-?\d[\d.eE+-]*|\"[^\"\n]*\"|[A-Za-z_:]+|[\[\](){}=]", text))
        if not words:
            return text
        word = dice.choice(words)
        other = dice.choice(words)[0] if dice.random() < 0.3 else dice.choice(ODD)
        how = dice.random()
        changed = "" if how < 0.15 else word[0] + " " + word[0] if how < 0.25 else other
        text = text[:word.start()] + changed + text[word.end():]
    return text[:dice.randrange(len(text))] if dice.random() < 0.05 else text


def survive(path, folder):
    """What is wrong with how it ended, or None; and its status."""
    command = [HEMIBAKE, "bake", path, "-o", os.path.join(folder, "out.glb"), "--quality", "draft", "--max-elements", "20000", "--time", "2", "--quiet"]
    environment = dict(os.environ, HEMIBAKE_USD_PYTHON=sys.executable)
    try:
        ran = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=PATIENCE_S, env=environment)
    except subprocess.TimeoutExpired:
        return "not done in %d s" % PATIENCE_S, "late"
    lines = [line for line in ran.stderr.splitlines() if line.strip() and "warning: " not in line]
    if ran.returncode not in PROMISED or "Traceback" in ran.stderr or "Sanitizer" in ran.stderr:
        return f"status {ran.returncode}: {ran.stderr.strip()[-200:]}", ran.returncode
    if ran.returncode == 1 and len(lines) != 1:
        return f"{len(lines)} lines: {ran.stderr.strip()[-200:]}", 1
    return None, ran.returncode


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1989)
    parser.add_argument("stages", nargs="*")
    asked = parser.parse_args()
    if subprocess.run([sys.executable, "-c", "import pxr"], capture_output=True, check=False).returncode != 0:
        print("skipped: this Python has no pxr")
        return 77
    texts = [STAGE]
    for path in asked.stages or sorted(glob.glob(os.path.join(ROOT, "..", "shared", "usd", "cases", "*.usda"))):
        with open(path, encoding="utf-8") as f:
            texts.append(f.read())
    dice, ended, wrong = random.Random(asked.seed), collections.Counter(), []
    with tempfile.TemporaryDirectory(prefix="hemibake usd ") as folder:
        for number in range(asked.count):
            path = os.path.join(folder, "stage.usda")
            text = damage(dice.choice(texts), dice)
            with open(path, "w", encoding="utf-8") as f:
                f.write(text)
            fault, status = survive(path, folder)
            ended[status] += 1
            if fault:
                kept = os.path.join(tempfile.gettempdir(), f"usd-{asked.seed}-{number}.usda")
                with open(kept, "w", encoding="utf-8") as f:
                    f.write(text)
                wrong.append(f"{kept}: {fault}")
    for line in wrong:
        print(line)
    print(f"{asked.count} stages of {len(texts)}: " + ", ".join(f"{n} ended with {status}" for status, n in sorted(ended.items(), key=str)) +
          f"; {len(wrong)} not as promised")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
