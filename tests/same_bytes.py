# SPDX-License-Identifier: MIT
"""Do two builds bake the same, byte for byte? For a change that is to change no output.

    python3 tests/same_bytes.py HEMIBAKE > before.txt
    python3 tests/same_bytes.py HEMIBAKE --before before.txt     [PART ...]: only files whose name holds one of these

Bakes at draft the samples, the pavilion with the sizes of its test, the scenes with truth and the cases from the field where ../shared
has them, and twenty files of the corpus where build/corpus has it (tests/corpus/fetch.sh) or $HEMIBAKE_CORPUS names it. Prints a digest
of each output, with the exit status and a digest of what was said. With --before the last line says how many are the same; exit status
1: not all.
"""

import argparse
import glob
import hashlib
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SHARED = os.path.join(os.path.dirname(ROOT), "shared")
CORPUS = os.environ.get("HEMIBAKE_CORPUS", os.path.join(ROOT, "build/corpus/packages"))
PAVILION = ("--patch-size", "2.25", "--element-size", "0.7", "--unshot", "0.03")
DARK = ("living-room", "bedroom", "zdm2", "apartment", "garage")
CORPUS_FILES, CORPUS_BYTES = 20, 200_000
PATIENCE_S = 300
SECONDS = re.compile(r"^time .*|\d+(\.\d+)? (s|min|ms|MiB)\b", re.MULTILINE)


def corpus():
    """Small ones, evenly among their names."""
    found = sorted(path for end in ("gltf", "glb") for path in glob.glob(f"{CORPUS}/**/*.{end}", recursive=True)
                   if os.path.getsize(path) <= CORPUS_BYTES)
    return [found[i * len(found) // CORPUS_FILES] for i in range(min(CORPUS_FILES, len(found)))]


def bakes():
    """(name, arguments after 'bake') of each."""
    sample = os.path.join(ROOT, "samples/pillar-room.glb")
    yield "pillar-room, medium", (sample,)
    yield "pillar-room, rows", (sample, "--quality", "draft", "--method", "rows")
    yield "pavilion", (os.path.join(ROOT, "samples/pavilion/pavilion.glb"), "--quality", "draft", *PAVILION)
    truth = glob.glob(f"{ROOT}/tests/accuracy/truth/*.glb") + glob.glob(f"{SHARED}/scenes/*.glb")
    for path in sorted(truth) + sorted(glob.glob(f"{SHARED}/field/*.glb")):
        name = os.path.splitext(os.path.basename(path))[0]
        yield name, (path, "--quality", "draft", *(("--environment", "1,1,1") if name in DARK else ()))
    for path in corpus():
        yield os.path.relpath(path, CORPUS), (path, "--quality", "draft", "--max-elements", "20000")


def digest(command, arguments, folder):
    """Of the output, the exit status, and what was said but for times."""
    output = os.path.join(folder, "out.glb")
    if os.path.exists(output):
        os.remove(output)
    try:
        ran = subprocess.run([command, "bake", *arguments, "-o", output, "--threads", "2"], capture_output=True, text=True,
                             errors="replace", timeout=PATIENCE_S, check=False)
    except subprocess.TimeoutExpired:
        return "too slow"
    data = b""
    if os.path.exists(output):
        with open(output, "rb") as f:
            data = f.read()
    said = SECONDS.sub("", ran.stdout + ran.stderr).replace(folder, "")
    return f"{ran.returncode} {hashlib.sha256(data).hexdigest()[:12]} {hashlib.sha256(said.encode()).hexdigest()[:6]}"


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("command")
    parser.add_argument("--before", type=argparse.FileType(encoding="utf-8"))
    parser.add_argument("parts", nargs="*")
    asked = parser.parse_intermixed_args()
    before = dict(line.rstrip("\n").split("\t") for line in asked.before) if asked.before else None
    count = same = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, arguments in bakes():
            if asked.parts and not any(part in name for part in asked.parts) or before is not None and name not in before:
                continue
            now = digest(os.path.abspath(asked.command), arguments, folder)
            is_same = before is None or before[name] == now
            count, same = count + 1, same + is_same
            print(f"{name}\t{now}" + ("" if is_same else f"\tDIFFERS: before {before[name]}"), flush=True)
    if before is None:
        return 0
    print(f"{same} of {count} are the same")
    return 0 if count and same == count else 1


if __name__ == "__main__":
    sys.exit(main())
