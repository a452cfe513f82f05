# SPDX-License-Identifier: MIT
"""What becomes of every file of the corpus? Each is baked as it is, and again with a lamp above it, with Draco and without.

A bake must end within 30 s and 1 GiB with an output or with one line. Seconds are the processor's, of one thread, so that
they are the same on a machine that does other things too; what sleeps is caught by a clock on the wall. An output must have no error for the Khronos
validator that its input has not, be read by glTF-Transform with the triangles that the report counts, and differ from its
input in nothing but what difference.py lists.
"""

import collections
import concurrent.futures
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys

import lamp
from difference import differences
from document import Document

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))
CORPUS = os.path.join(ROOT, "build/corpus")
PATIENCE_S, PATIENCE_ASLEEP_S, MEMORY = 30, 600, 1 << 30
# Exit status 4: --time ran out first, which is fine here.
BAKED = (0, 4)
WAYS = {
    "plain": [],
    "lit": [],
    "linear": ["--scene-linear", "--no-draco"],
    "pbr": ["--keep-pbr"],
}

Result = collections.namedtuple("Result", "file way input output status said report seconds")


def find_files(parts):
    packages = os.path.join(CORPUS, "packages")
    for folder, folders, names in os.walk(packages):
        folders.sort()
        for name in sorted(names):
            path = os.path.join(folder, name)
            if name.lower().endswith((".gltf", ".glb")) and all(p in path for p in parts):
                yield os.path.relpath(path, packages)


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE_S, PATIENCE_S))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def make_input(file, way, folder):
    source = os.path.join(CORPUS, "packages", file)
    if way == "plain":
        return source
    document = Document(source, literal=False)
    lamp.add_lamp(document)
    path = os.path.join(folder, "lit" + os.path.splitext(file)[1])
    lamp.write(document, path)
    return path


def bake(task):
    file, way, folder = task
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(os.path.join(folder, "in"))
    output = os.path.join(folder, "out.gltf" if way == "linear" else "out.glb")
    report = os.path.join(folder, "out.json")
    try:
        source = make_input(file, way, os.path.join(folder, "in"))
    except Exception as error:  # what the lamp cannot be added to, the plain bake refuses too
        return Result(file, way, None, None, 1, f"(no lamp: {type(error).__name__} {error})", None, 0.0)
    command = [HEMIBAKE, "bake", source, "-o", output, "--report", report, "--quality", "draft", "--time", "1", "--threads", "1",
               "--quiet", *WAYS[way]]
    before = used_seconds()
    try:
        ran = subprocess.run(command, capture_output=True, timeout=PATIENCE_ASLEEP_S, preexec_fn=limit)
    except subprocess.TimeoutExpired:
        return Result(file, way, source, None, "hang", "", None, used_seconds() - before)
    counts = json.load(open(report)) if ran.returncode in BAKED else None
    status = "hang" if ran.returncode in (-signal.SIGXCPU, -signal.SIGKILL) else ran.returncode
    return Result(file, way, source, output, status, ran.stderr.decode(errors="replace"), counts, used_seconds() - before)


def used_seconds():
    """Of processors, by the bakes that this process has waited for: each has a process of its own to wait for it."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def ask_readers(paths):
    ran = subprocess.run(["node", "readers.mjs"], cwd=os.path.join(CORPUS, "node"), input="\n".join(paths) + "\n",
                         capture_output=True, text=True, check=True)
    return {said["path"]: said for said in map(json.loads, ran.stdout.splitlines())}


def judge(result, readers):
    """Problems of one bake; none: it passed."""
    if result.status == 1:
        ok = result.input is None or re.fullmatch(r"hemibake: [^\n]+: [^\n]+\n", result.said)
        return [] if ok else [f"not one clear line: {result.said!r}"]
    if result.status not in BAKED:
        return [f"ended with {result.status}: {result.said[:300]!r}"]
    before, after = readers[result.input], readers[result.output]
    old = {error.split()[0] for error in before["errors"]}
    problems = [f"validator: {error}" for error in after["errors"] if error.split()[0] not in old]
    if "unreadable" in after and "unreadable" not in before:
        problems.append(f"glTF-Transform: {after['unreadable']}")
    elif "unreadable" not in after:
        problems += check_counts(result, after)
    try:
        lost, _ = differences(Document(result.input), Document(result.output))
    except (TypeError, AttributeError, KeyError, IndexError) as error:
        lost = [f"cannot be compared: {type(error).__name__} {error}"]
    return problems + lost[:8]


def check_counts(result, after):
    document = Document(result.output)
    expected = {"nodes": len(document.list("nodes")), "meshes": len(document.list("meshes"))}
    accessors = document.list("accessors")
    primitives = [p for mesh in document.list("meshes") for p in mesh["primitives"]]
    expected["vertices"] = sum(accessors[p["attributes"]["POSITION"]]["count"] for p in primitives if "POSITION" in p["attributes"])
    problems = [f"glTF-Transform counts {after[k]} {k}, the file says {v}" for k, v in expected.items() if after[k] != v]
    if after["triangles"] < result.report["scene"]["triangles_out"]:
        problems.append(f"{after['triangles']} triangles, but {result.report['scene']['triangles_out']} were baked")
    return problems


def main():
    files = list(find_files(sys.argv[1:]))
    tasks = [(file, way, os.path.join(CORPUS, "out", f"{i}.{way}")) for i, file in enumerate(files) for way in WAYS]
    with concurrent.futures.ProcessPoolExecutor(int(os.environ.get("HEMIBAKE_JOBS", "2"))) as pool:
        results = list(pool.map(bake, tasks))
    baked = [r for r in results if r.status in BAKED]
    readers = ask_readers([p for r in baked for p in (r.input, r.output)])
    passed = failed = 0
    verdicts = collections.defaultdict(dict)
    for result in results:
        problems = judge(result, readers)
        verdicts[result.file][result.way] = problems, result
        failed += bool(problems)
        passed += not problems
    for file, ways in verdicts.items():
        print_file(file, ways)
    packages = {file.split("/")[0] for file in files}
    print(f"{len(files)} files in {len(packages)} packages, {sum(1 for w in verdicts.values() if any(r.status in BAKED for _, r in w.values()))}"
          f" of them baked; {len(baked)} outputs")
    slowest = max(results, key=lambda r: r.seconds)
    largest = max(baked, key=lambda r: r.report["memory"]["peak_bytes"])
    print(f"slowest: {slowest.seconds:.1f} s, {slowest.file} ({slowest.way}); largest: "
          f"{largest.report['memory']['peak_bytes'] / 2**20:.0f} MiB, {largest.file} ({largest.way})")
    print(f"{passed} passed, {failed} failed")
    return failed > 0


def print_file(file, ways):
    words = []
    for way, (problems, result) in ways.items():
        words.append(f"{way} {'FAILED' if problems else 'baked' if result.status in BAKED else 'refused'}")
    print(f"{file}: {', '.join(words)}")
    said = {result.said.split(": ", 2)[-1].strip() for _, result in ways.values() if result.status == 1 and result.input}
    for line in sorted(said):
        print(f"    says: {line}")
    for way, (problems, _) in ways.items():
        for problem in problems:
            print(f"    {way}: {problem}")


if __name__ == "__main__":
    sys.exit(main())
