# SPDX-License-Identifier: MIT
"""What does a host cost on top of the command? CPU time and peak memory of the same bake through Python and Node.

    python3 tests/bench/hosts.py BUILD_FOLDER [RUNS] [--check]

Each way is a process of its own, and they take turns, so that whatever else the machine does falls on all; medians of RUNS
(5). CPU time is user plus system of all threads and children, with one worker thread: wall clocks say more about the machine's
other work. From a host's numbers those of its baseline are taken: the same process that imports, reads and writes, and does
not bake. --check: exit status 1 past 5 % of time or 10 % of memory.

The packages are those that tests/hosts/python/run.sh and tests/hosts/gltf-transform/run.sh have put into the build folder.
"""

import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
ROOM = os.path.join(ROOT, "samples/pillar-room.glb")
NODE_PLACE = os.path.join(ROOT, "build/tests/gltf-transform")

# The issue's own limits.
TIME_LIMIT, MEMORY_LIMIT = 0.05, 0.10

PYTHON = "import sys, hemibake\nif sys.argv[3] == 'bake': hemibake.bake(sys.argv[1], sys.argv[2], no_draco=True, threads=1)"
PYTHON_SCENE = """
import json, sys, time, numpy as np, hemibake
scene = hemibake.Scene(hemibake.Context(threads=1))
grey, lamp = scene.add_material(), scene.add_material(emission=(1, 1, 1))
square = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
floor = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]], np.float32)
scene.add_mesh(floor, square, grey)
scene.add_mesh(floor[::-1] + np.float32([0, 1, 0]), square, lamp)
began = time.perf_counter()
solution = scene.bake(quality="medium", progress=lambda *_: None)
light = [solution.mesh(i).radiance.sum() for i in (0, 1)]
took = time.perf_counter() - began
print(json.dumps([took, solution.statistics["time"]["total_s"]]))
"""
NODE = """
import { makeIO } from './rooms.mjs';
import { bake } from 'hemibake-gltf-transform';
const [asset, out, what] = process.argv.slice(1);
const io = await makeIO();
const document = await io.read(asset);
if (what === 'bake') await document.transform(bake({ threads: 1 }));
await io.write(out, document);
"""


def measure(command, cwd=ROOT):
    """(CPU seconds, wall seconds, peak bytes) of a process and its children."""
    began = time.monotonic()
    process = subprocess.Popen(command, cwd=cwd, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"hosts.py: {command[0]} ended with status {process.returncode}")
    return usage.ru_utime + usage.ru_stime, time.monotonic() - began, usage.ru_maxrss * 1024


def ways(build, folder):
    """{name: (command, baseline)}"""
    program, out = os.path.join(build, "bin/hemibake"), os.path.join(folder, "out.glb")
    python = [os.path.join(build, "tests/python/bin/python"), "-B", "-c", PYTHON, ROOM, out]
    node = ["node", "--input-type=module", "-e", NODE, ROOM, out]
    return {
        "command": ([program, "bake", ROOM, "-o", out, "--quiet", "--no-draco", "--threads", "1"], [program, "--version"]),
        "python": ([*python, "bake"], [*python, "nothing"]),
        "node": ([*node, "bake"], [*node, "nothing"]),
    }


def collect(build, runs):
    """{name: ([whole ...], [baseline ...])}"""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(runs):
            for name, pair in ways(build, folder).items():
                for kind, command in enumerate(pair):
                    place = NODE_PLACE if name == "node" else ROOT
                    found.setdefault(name, ([], []))[kind].append(measure(command, place))
    return found


def scene_overhead(build, runs):
    """Median of what a call of Scene.bake takes beyond the library's own time, as a share of that."""
    shares = []
    for _ in range(runs):
        python = os.path.join(build, "tests/python/bin/python")
        ran = subprocess.run([python, "-B", "-c", PYTHON_SCENE], capture_output=True, check=True, text=True)
        took, library = json.loads(ran.stdout)
        shares.append(took / library - 1)
    return statistics.median(shares)


def net(found, name):
    """CPU seconds and peak bytes of each bake of `name` without its own baseline. The command's start is part of its bake; Python's
    bake is a child beside Python, so the larger of the two peaks is the child's alone."""
    whole, baseline = found[name]
    if name == "command":
        return [w[0] for w in whole], [w[2] for w in whole]
    peaks = [w[2] if name == "python" else w[2] - b[2] for w, b in zip(whole, baseline)]
    return [w[0] - b[0] for w, b in zip(whole, baseline)], peaks


def beyond(found, name):
    """How far CPU time and memory are beyond the command's: medians of the runs' ratios, and the ratio of the least times, since
    a machine that does other work only ever adds to them."""
    (times, peaks), (alone, alone_peaks) = net(found, name), net(found, "command")
    median = statistics.median(a / b for a, b in zip(times, alone)) - 1
    return median, min(times) / min(alone) - 1, statistics.median(peaks) / statistics.median(alone_peaks) - 1


def table(found):
    print(f"{'':8} {'CPU s':>7} {'own':>6} {'wall s':>7} {'peak MiB':>9} {'own':>6}   beyond the command, without its own")
    late = []
    for name, (whole, baseline) in found.items():
        cpu, wall, peak = (statistics.median(column) for column in zip(*whole))
        own_cpu, _, own_peak = (statistics.median(column) for column in zip(*baseline))
        median, least, memory = beyond(found, name)
        print(f"{name:8} {cpu:7.2f} {own_cpu:6.2f} {wall:7.2f} {peak / 2**20:9.1f} {own_peak / 2**20:6.1f}"
              f"   time {100 * median:+.1f} % (least {100 * least:+.1f} %), memory {100 * memory:+.1f} %")
        if min(median, least) > TIME_LIMIT or memory > MEMORY_LIMIT:
            late.append(name)
    return late


def main():
    words = [word for word in sys.argv[1:] if word != "--check"]
    check = "--check" in sys.argv
    build, runs = os.path.abspath(words[0]), int(words[1]) if len(words) > 1 else 5
    needed = (os.path.join(build, "tests/python/bin/python"), os.path.join(NODE_PLACE, "node_modules/hemibake-gltf-transform"))
    if not all(map(os.path.exists, needed)):
        print("hosts.py: skipped: there are no packages to measure; the tests of Python and glTF-Transform put them there", file=sys.stderr)
        sys.exit(77)
    commit = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%h"], capture_output=True, text=True).stdout.strip()
    print(f"# {commit or 'no commit'}, {platform.machine()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {runs} runs")
    found = collect(build, runs)
    late = table(found)
    if late and check:
        print("once more, with as many runs again")
        for name, (whole, baseline) in collect(build, runs).items():
            found[name][0].extend(whole)
            found[name][1].extend(baseline)
        late = table(found)
    share = scene_overhead(build, runs)
    print(f"Python's Scene.bake with a callback: {100 * share:+.2f} % beyond the library's own time")
    if share > TIME_LIMIT:
        late.append("Scene")
    if late and check:
        sys.exit(f"hosts.py: past the limit: {', '.join(late)}")


main()
