# SPDX-License-Identifier: MIT
"""Which findings of analyzers are judged, and which are not? For analyze.sh.

    analyze.py commands FROM.json TO.json     the compile commands of what is ours and no test
    analyze.py files COMMANDS.json            one file a line
    analyze.py analyze COMMANDS.json          gcc -fanalyzer on every C file, two at a time
    analyze.py judge TOOL LOG JUDGED.txt      what the log finds that JUDGED.txt does not name; exit status 1 if there is any

A line of JUDGED.txt is `tool path id: reason`; path may be a pattern, as in a shell.
"""

import fnmatch
import json
import os
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
OURS = ("plugin/", "converters/", "color/")

# file:line[:column]: [warning:] message [id], or cppcheck's file:line: id: message.
FINDING = re.compile(r"^(?P<file>[^\s:]+):(?P<line>\d+):(?:\d+:)? (?:warning: .*\[(?P<last>[\w.,+=-]+)\]|(?P<first>\w+): .*)$")


def relative(path):
    """To the tree, of a path that is one already, or is relative to the build."""
    for folder in (ROOT, os.path.join(ROOT, "build/release")):
        if os.path.exists(os.path.join(folder, path)):
            return os.path.relpath(os.path.join(folder, path), ROOT)
    return path


def commands(source, target):
    with open(source, encoding="utf-8") as f:
        every = json.load(f)
    seen, kept = set(), []
    for one in every:
        name = relative(one["file"])
        if name.startswith(OURS) and name not in seen:
            seen.add(name)
            kept.append(one)
    with open(target, "w", encoding="utf-8") as f:
        json.dump(kept, f, indent=1)


def analyze(one):
    words = shlex.split(one["command"])
    if not one["file"].endswith(".c"):
        return ""
    words[words.index("-o") + 1] = os.devnull
    # As it is written: of loops that are unrolled and calls that are inlined it finds what cannot be.
    words += ["-O0", "-U_FORTIFY_SOURCE", "-fanalyzer", "-Wno-analyzer-too-complex"]
    return subprocess.run(words, cwd=one["directory"], stderr=subprocess.PIPE, text=True).stderr


def findings(log):
    """(path, line, id, the line of the log), each once."""
    seen = set()
    with open(log, encoding="utf-8", errors="replace") as f:
        for text in f:
            met = FINDING.match(text.strip())
            if not met or (met["first"] in ("note", "error") and not met["last"]):
                continue
            name, what = relative(met["file"]), met["last"] or met["first"]
            if name.startswith(OURS) and (name, met["line"], what) not in seen:
                seen.add((name, met["line"], what))
                yield name, int(met["line"]), what.split(",")[0], text.strip()


def judged_of(tool, path):
    out = []
    with open(path, encoding="utf-8") as f:
        for line in f:
            words = line.split(None, 3)
            if line.strip() and not line.startswith("#") and words[0] == tool:
                out.append((words[1], words[2].rstrip(":"), line.strip()))
    return out


def judge(tool, log, path):
    judged, used, left, all_of = judged_of(tool, path), set(), [], 0
    for name, _, what, text in findings(log):
        all_of += 1
        met = [line for pattern, known, line in judged if fnmatch.fnmatch(name, pattern) and fnmatch.fnmatch(what, known)]
        used.update(met)
        if not met:
            left.append(text)
    for text in left:
        print(f"{tool}: {text}")
    for _, _, line in judged:
        if line not in used:
            print(f"{tool}: meets nothing: {line}")
    print(f"{tool}: {all_of} findings, {all_of - len(left)} judged, {len(left)} not")
    return 1 if left else 0


def main():
    what, *rest = sys.argv[1:]
    if what == "commands":
        commands(*rest)
    elif what == "judge":
        return judge(*rest)
    else:
        with open(rest[0], encoding="utf-8") as f:
            every = json.load(f)
        if what == "files":
            print("\n".join(one["file"] for one in every))
        else:
            with ThreadPoolExecutor(2) as pool:
                for text in pool.map(analyze, every):
                    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
