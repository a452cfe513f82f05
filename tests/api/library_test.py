# SPDX-License-Identifier: MIT
"""Do the libraries show what the header promises, and nothing else? No other name, no variable that can change, no memory past the allocator.

    library_test.py BUILD_FOLDER HEADER_FOLDER
"""

import os
import re
import subprocess
import sys
import unittest

BUILD, HEADERS = sys.argv[1:3]
SHARED = os.path.join(BUILD, "lib/libhemibake.so")
STATIC = os.path.join(BUILD, "lib/libhemibake.a")
TABLE = "hemi_plugin_table"


def header(name):
    with open(os.path.join(HEADERS, "hemibake", name)) as f:
        return re.sub(r"/\*.*?\*/", "", f.read(), flags=re.S)


def headers():
    return "".join(header(name) for name in sorted(os.listdir(os.path.join(HEADERS, "hemibake"))) if name.endswith(".h"))


def declared():
    return set(re.findall(r"\b(hemi_\w+)\(", "".join(re.findall(r"^HEMI_API[^;]*;", headers(), re.M))))


def symbols(*arguments):
    """(name, kind, section) of what nm lists."""
    lines = subprocess.run(["nm", "-f", "sysv", *arguments], capture_output=True, check=True, text=True).stdout
    for line in lines.splitlines():
        fields = [field.strip() for field in line.split("|")]
        if len(fields) == 7:
            yield fields[0], fields[2], fields[6]


class Library(unittest.TestCase):
    def test_the_header_declares_functions_at_all(self):
        self.assertGreater(len(declared()), 15)

    def test_the_shared_library_shows_the_header_and_the_table(self):
        shown = {name.split("@")[0] for name, kind, _ in symbols("-D", "--defined-only", SHARED) if kind != "A"}
        self.assertEqual(shown, declared() | {TABLE})

    def test_the_static_library_shows_no_name_that_a_host_might_have(self):
        shown = {name for name, kind, _ in symbols("-g", "--defined-only", STATIC) if kind not in "WVu"}
        self.assertEqual(shown, declared() | {TABLE})

    def test_no_variable_can_change(self):
        seen = 0
        for name, _, section in symbols("--defined-only", STATIC):
            seen += 1
            # .data.rel.ro is constant once it is loaded; the other .data.rel.* of C++ are references to type names.
            writable = re.fullmatch(r"\.(data|bss|tdata|tbss)(\..*)?|\*COM\*", section)
            constant = section.startswith(".data.rel.ro") or name.startswith("DW.ref.")
            # One thread of a process at a time calls Mesa, whichever context is its own: that takes a lock for all.
            constant = constant or name in ("osmesa_turn", "egl_turn")
            self.assertFalse(writable and not constant, f"{name} in {section}")
        self.assertGreater(seen, 500)

    def test_the_library_takes_memory_in_one_place_a_layer(self):
        allowed = {"plugin/core/libhemibake_geometry.a": {"block.c.o"}, "plugin/core/libhemibake_core.a": set(),
                   "plugin/api/libhemibake.a": {"context.c.o"}}
        for library, places in allowed.items():
            lines = subprocess.run(["nm", "-A", "-u", os.path.join(BUILD, library)], capture_output=True, check=True,
                                   text=True).stdout.splitlines()
            users = {line.split(":")[1] for line in lines
                     if line.split()[-1] in ("malloc", "calloc", "realloc", "aligned_alloc", "free", "strdup")}
            self.assertEqual(users, places, "call block_new and its like instead")

    def test_the_table_has_every_function(self):
        body = re.search(r"typedef struct hemi_plugin \{(.*?)\} hemi_plugin;", header("plugin_table.h"), re.S).group(1)
        self.assertEqual({"hemi_" + name for name in re.findall(r"\(\*(\w+)\)", body)}, declared())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
