# SPDX-License-Identifier: MIT
"""Would the tests notice? See mutations.sh.

A mutation is a place in the product, found by its text wherever the file lies, another text for it, and the CTest names
(a regular expression) of which at least one must fail. All is done in a copy of the tree in build/mutations, whose one build
folder serves every mutation. The tests run before any of it: one that fails unmutated, or is skipped, proves nothing.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PLACE = os.path.join(ROOT, "build", "mutations")
TREE = os.path.join(PLACE, "tree")
BUILD = os.path.join(TREE, "build", "release")
LIST = os.path.join(ROOT, "tests", "mutations.txt")

PRODUCT = ("plugin", "converters", "color")
CODE = (".c", ".cpp", ".h", ".py", ".mjs", ".cmake", ".def")
FIELDS = ("name", "what", "in", "old", "new", "test")

# A mutation may make a loop endless; the slowest of the tests takes a minute.
TEST_TIMEOUT_S = 240
JOBS = 2


class Fault(Exception):
    """The list does not fit the tree."""


# ---- the list --------------------------------------------------------------------------------------------------------


def read_list(path=LIST):
    """Blocks of 'field: text', between empty lines; # begins a comment line."""
    found = []
    with open(path, encoding="utf-8") as f:
        for block in re.split(r"\n\s*\n", f.read()):
            lines = [line for line in block.splitlines() if line and not line.startswith("#")]
            if not lines:
                continue
            one = {"in": ""}
            for line in lines:
                field, _, text = line.partition(": ")
                if field not in FIELDS or field in one and field != "in":
                    raise Fault(f"mutations.txt: what is '{line}'?")
                one[field] = text
            missing = [field for field in FIELDS if field not in one]
            if missing or any(other["name"] == one["name"] for other in found):
                raise Fault(f"mutations.txt: {one.get('name')}: lacks {missing}, or is there twice")
            found.append(one)
    return found


def product_files(root):
    for folder in PRODUCT:
        for at, folders, names in os.walk(os.path.join(root, folder)):
            folders.sort()
            yield from (os.path.join(at, name) for name in sorted(names) if name.endswith(CODE))


def find_place(one, texts):
    """The one file that holds the old text once, however it was moved."""
    places = [path for path, text in texts.items() if one["in"] in path for _ in range(text.count(one["old"]))]
    if len(places) != 1:
        raise Fault(f"{one['name']}: its text is in {len(places)} places of the product, {places or 'none'}: {one['old']}")
    return places[0]


def find_places(mutations, root):
    texts = {}
    for path in product_files(root):
        with open(path, encoding="utf-8") as f:
            texts[os.path.relpath(path, root)] = f.read()
    faults = []
    for one in mutations:
        try:
            one["file"] = find_place(one, texts)
        except Fault as fault:
            faults.append(str(fault))
    if faults:
        raise Fault("\n".join(faults))


# ---- the copy --------------------------------------------------------------------------------------------------------


def write(path, data):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(data)


def copy_tree():
    """Files that did not change keep their times, so that little is built again; what is gone from the tree goes."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=True,
                            capture_output=True).stdout.decode().split("\0")
    names = {name for name in listed if name and os.path.isfile(os.path.join(ROOT, name))}
    for at, folders, files in os.walk(TREE):
        if at == TREE and "build" in folders:
            folders.remove("build")
        for name in files:
            if os.path.relpath(os.path.join(at, name), TREE) not in names:
                os.remove(os.path.join(at, name))
    for name in sorted(names):
        source, target = os.path.join(ROOT, name), os.path.join(TREE, name)
        with open(source, "rb") as f:
            data = f.read()
        if os.path.isfile(target):
            with open(target, "rb") as f:
                if f.read() == data:
                    continue
        write(target, data)
        shutil.copymode(source, target)
    modules = os.path.join(ROOT, "build", "tests")
    if os.path.isdir(modules) and not os.path.isdir(os.path.join(TREE, "build", "tests")):
        shutil.copytree(modules, os.path.join(TREE, "build", "tests"), symlinks=True)


def run(*command, timeout=None):
    """Output and status; the compiler's cache, if there is one, knows files by their place in the tree."""
    environment = {**os.environ, "CCACHE_BASEDIR": TREE, "CCACHE_NOHASHDIR": "1"}
    ran = subprocess.run(command, cwd=TREE, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                         errors="replace", timeout=timeout, check=False)
    return ran.returncode, ran.stdout


def must(*command):
    status, output = run(*command)
    if status != 0:
        raise Fault(f"{' '.join(command)}\n{output[-4000:]}")
    return output


def configure():
    launcher = ["-DCMAKE_C_COMPILER_LAUNCHER=ccache", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    must("cmake", "--preset", "release", "-DHEMIBAKE_TESTS=ON", *launcher)


def tests_of(pattern):
    """Names of the CTest tests that a regular expression finds."""
    return re.findall(r"^ *Test +#\d+: (\S+)", must("ctest", "--test-dir", BUILD, "-N", "-R", f"^({pattern})$"), re.M)


NEEDED = {"faults": ["broken_calls"], "accuracy.hard_cases": ["pathtrace"]}  # what a test runs beside the command
INSTALLED = {"hemibake_cli", "hemibake_shared", "hemibake_static", "hemibake_node", "hemibake_node_work"}


def targets_of(names):
    """What must be built for tests: their own programs, the command, or what hosts install."""
    targets = set()
    for name in names:
        if name.startswith("hosts."):
            targets |= INSTALLED
        elif name.startswith(("cli.", "accuracy.", "faults", "field.")) and not name.startswith("accuracy.figure"):
            targets |= {"hemibake_cli", *NEEDED.get(name, ())}
        else:
            targets |= {"test_" + name.replace(".", "_")}
    return sorted(targets)


def build(names):
    """Output and status."""
    return run("cmake", "--build", BUILD, "--target", *targets_of(names), "--", f"-j{JOBS}")


def run_tests(names, *more):
    """Those that pass and those that fail; what is skipped does neither."""
    pattern = "|".join(map(re.escape, names))
    _, output = run("ctest", "--test-dir", BUILD, "-R", f"^({pattern})$", "--timeout", str(TEST_TIMEOUT_S), "-j", str(JOBS), *more)
    passed = re.findall(r"Test +#\d+: (\S+) \.+ *Passed", output)
    return passed, re.findall(r"Test +#\d+: (\S+) \.+\*+ *(?:Failed|Timeout|Exception)", output)


# ---- the mutations ---------------------------------------------------------------------------------------------------


def check_unmutated(mutations):
    """Takes the tests away that do not pass as it is."""
    names = sorted({name for one in mutations for name in one["tests"]})
    status, output = build(names)
    if status != 0:
        raise Fault(f"the tree does not build:\n{output[-4000:]}")
    passed, _ = run_tests(names)
    for name in sorted(set(names) - set(passed)):
        print(f"{name} fails, or is skipped, before anything is broken")
    for one in mutations:
        one["tests"] = [name for name in one["tests"] if name in passed]
    return passed


def try_mutation(one):
    """What is printed, and whether a test noticed."""
    if not one["tests"]:
        return "NO TEST THAT PASSES", False
    path = os.path.join(TREE, one["file"])
    with open(path, encoding="utf-8") as f:
        text = f.read()
    try:
        write(path, text.replace(one["old"], one["new"]).encode())
        status, output = build(one["tests"])
        if status != 0:
            print(output[-2000:], file=sys.stderr)
            return "DOES NOT BUILD", False
        _, failed = run_tests(one["tests"], "--stop-on-failure")
        return ", ".join(failed) or "NOT NOTICED", bool(failed)
    finally:
        write(path, text.encode())


def print_row(*cells):
    print(" | ".join(str(cell) for cell in cells), flush=True)


def list_table(mutations):
    print("| mutation | where | what is broken | noticed by |\n|---|---|---|---|")
    for one in mutations:
        where = os.path.dirname(one["file"]).replace("plugin/core/", "core/")
        print(f"| {one['name']} | `{where}` | {one['what']} | `{one['test']}` |")


def chosen(mutations, names):
    if not names:
        return mutations
    found = [one for one in mutations if one["name"].startswith(tuple(names))]
    if not found:
        raise Fault("no mutation is called so")
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*")
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    begin = time.monotonic()
    mutations = chosen(read_list(), arguments.names)
    find_places(mutations, ROOT)
    if arguments.list:
        return list_table(mutations)
    copy_tree()
    configure()
    for one in mutations:
        one["tests"] = tests_of(one["test"])
        if not one["tests"]:
            raise Fault(f"{one['name']}: no test is called {one['test']}")
    passed = check_unmutated(mutations)
    print(f"{len(passed)} tests pass unmutated, {time.monotonic() - begin:.0f} s", flush=True)
    noticed = 0
    for one in mutations:
        start = time.monotonic()
        verdict, is_noticed = try_mutation(one)
        noticed += is_noticed
        print_row(one["name"], one["file"], one["what"], verdict, f"{time.monotonic() - start:.0f} s")
    print(f"{noticed} of {len(mutations)} noticed, {time.monotonic() - begin:.0f} s")
    return 0 if noticed == len(mutations) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Fault as fault:
        sys.exit(f"mutations.py: {fault}")
