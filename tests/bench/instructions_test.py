# SPDX-License-Identifier: MIT
"""Does the guard of instructions.py notice? Counts that are known, against counts that are stored."""

import contextlib
import io
import os
import sys
import tempfile
import unittest

from instructions import compare, instructions

STORED = {"compiler": "gcc 12", "bakes": {"lamp": {"own": 1000, "all": 2000}}}

# What valgrind writes: names are given once and then by number; the line after calls= is the callee's, counted there.
CALLGRIND = """events: Ir
ob=(1) /bin/hemibake
fl=(1) ???
fn=(1) main
0 100
cob=(2) /lib/libOSMesa.so
cfn=(2) draw
calls=3 0
0 5000
+4 20
ob=(2)
fn=(2)
0 5000
ob=(1)
fn=(3) write
* 7
totals: 5127
"""


def failures(own, everything, compiler="gcc 12"):
    with contextlib.redirect_stdout(io.StringIO()):
        return compare({"lamp": {"own": own, "all": everything}}, STORED, compiler)


class Instructions(unittest.TestCase):
    def test_the_same_passes(self):
        self.assertEqual(failures(1000, 2000), [])

    def test_less_passes(self):
        self.assertEqual(failures(500, 900), [])

    def test_a_tenth_more_of_our_own_fails(self):
        self.assertEqual(len(failures(1101, 2000)), 1)

    def test_more_of_everything_fails(self):
        self.assertEqual(len(failures(1000, 2201)), 1)

    def test_another_compiler_is_given_more_room_and_not_any(self):
        self.assertEqual(failures(1200, 2000, "gcc 14"), [])
        self.assertEqual(len(failures(1300, 2000, "gcc 14")), 1)

    def test_a_bake_that_is_not_stored_fails(self):
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(len(compare({"new": {"own": 1, "all": 1}}, STORED, "gcc 12")), 1)

    def test_calls_are_counted_where_they_happen(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "callgrind")
            with open(path, "w", encoding="utf-8") as f:
                f.write(CALLGRIND)
            self.assertEqual(instructions(path, "/bin/hemibake"), {"own": 127, "all": 5127})


if __name__ == "__main__":
    sys.exit(unittest.main())
