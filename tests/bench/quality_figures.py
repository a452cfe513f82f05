# SPDX-License-Identifier: MIT
"""What does each quality cost and give on three scenes with truth? The figures that `hemibake help quality` prints.

    python3 tests/bench/quality_figures.py                       measures, and writes plugin/hosts/cli/quality_figures.h; minutes
    python3 tests/bench/quality_figures.py --check [QUALITY]     do bakes at QUALITY (draft) still give what stands there? Status 1: no

Time is processor time of the whole process, since clocks say how busy a machine is; it and memory are of one machine, and are not
checked. Elements, error and bytes are the same wherever it is baked, but for rounding. The third scene is in ../shared, and passed over
where that is not there. HEMIBAKE: the program.
"""

import json
import os
import re
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
FIGURES = os.path.join(ROOT, "plugin/hosts/cli/quality_figures.h")
SCENES = {"pillar-room": ("tests/accuracy/truth", ()), "cornell-box": ("tests/accuracy/truth", ()),
          "living-room": ("../shared/scenes", ("--environment", "1,1,1"))}
QUALITIES = ("draft", "medium", "high")
# What is found, as a share of what is told: a promise that is not kept by more than rounding on another processor is stale, and so is one
# that bakes have left far behind.
STALE = (0.6, 1.15)

HEAD = """/* SPDX-License-Identifier: MIT
 * What does each quality cost and give? Made by tests/bench/quality_figures.py, which also says whether it still holds.
 */
/* scene, quality, surfaces, elements, error against path-traced probes in %, processor seconds, MiB, kB of the output */
"""
LINE = 'QUALITY_FIGURES("{scene}", "{quality}", {surfaces}, {elements}, {error:.2f}, {seconds:.2f}, {mib:.0f}, {kb:.0f})\n'
READ = re.compile(r'QUALITY_FIGURES\("([^"]+)", "([^"]+)", (\d+), (\d+), ([\d.]+), ([\d.]+), (\d+), (\d+)\)')


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(scene, quality):
    folder, options = SCENES[scene]
    path = os.path.join(ROOT, folder, scene)
    with tempfile.TemporaryDirectory() as place:
        told, begin = os.path.join(place, "report.json"), processor_s()
        subprocess.run([HEMIBAKE, "bake", path + ".glb", "-o", os.path.join(place, "out.glb"), "--quality", quality, "--report", told,
                        "--reference", path + ".hprb", "-q", *options], check=True)
        seconds = processor_s() - begin
        with open(told) as f:
            report = json.load(f)
    return {"scene": scene, "quality": quality, "surfaces": report["scene"]["surfaces"], "elements": report["scene"]["elements"],
            "error": 100 * report["error"]["reference"], "seconds": seconds, "mib": report["memory"]["peak_bytes"] / 2**20, "kb": report["output"]["bytes"] / 1000}


def here():
    """The scenes that are here."""
    return [scene for scene, (folder, _) in SCENES.items() if os.path.exists(os.path.join(ROOT, folder, scene + ".glb"))]


def write():
    if len(here()) < len(SCENES):
        sys.exit("quality_figures.py: all scenes are needed to write the figures")
    lines = []
    for scene in SCENES:
        for quality in QUALITIES:
            lines.append(LINE.format(**measure(scene, quality)))
            print(lines[-1], end="", flush=True)
    with open(FIGURES, "w") as f:
        f.write(HEAD + "".join(lines))
    return 0


def check(quality):
    with open(FIGURES) as f:
        stored = {(m[0], m[1]): tuple(map(float, m[2:])) for m in READ.findall(f.read())}
    assert len(stored) == len(SCENES) * len(QUALITIES), stored
    stale = 0
    for scene in here():
        found, told = measure(scene, quality), stored[scene, quality]
        for name, is_told in (("elements", told[1]), ("error", told[2]), ("kb", told[5])):
            holds = STALE[0] <= found[name] / is_told <= STALE[1]
            stale += not holds
            print(f"{scene}, {quality}: {name} {found[name]:.4g}, told {is_told:g}{'' if holds else ': stale'}")
    if stale:
        print("run python3 tests/bench/quality_figures.py")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(check((sys.argv[2:] or ["draft"])[0]) if sys.argv[1:2] == ["--check"] else write())
