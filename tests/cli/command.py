# SPDX-License-Identifier: MIT
"""How does a test run hemibake? In a folder of its own, with what it printed, its status, and which files it left.

Tests are unittest cases on CommandCase; main() ends with 77, CTest's word for skipped, if every one was skipped.
"""

import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SAMPLES = os.path.join(ROOT, "samples")
HEMIBAKE = os.environ.get("HEMIBAKE", os.path.join(ROOT, "build/release/bin/hemibake"))

DONE, BAD_INPUT, USAGE, OUTPUT, NOT_CONVERGED, INTERRUPTED = 0, 1, 2, 3, 4, 130

# The configuration of whoever runs the tests is none of theirs.
os.environ.pop("OCIO", None)

# A hang is a failure; a sanitized build on a busy machine is slow.
PATIENCE_S = 300

SANITIZER_WORDS = ("Sanitizer", "runtime error:")


class CommandCase(unittest.TestCase):
    """Each test starts in an empty folder, self.folder; a space in its name proves that paths are taken whole."""

    maxDiff = None

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="hemibake test ")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as f:
            f.write(data)
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as f:
            return f.read()

    def left(self):
        """Every file and folder under the test's folder."""
        return sorted(
            os.path.relpath(os.path.join(at, name), self.folder)
            for at, folders, files in os.walk(self.folder)
            for name in folders + files
        )

    def run_hemibake(self, *arguments, **popen):
        """stdout, stderr and returncode of the command, run in the test's folder; a sanitizer's word is a failure."""
        ran = subprocess.run(
            [HEMIBAKE, *map(str, arguments)],
            cwd=self.folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
            timeout=PATIENCE_S, **popen,
        )
        self.check_sanitizers(ran.stderr)
        self.assertGreaterEqual(ran.returncode, 0, f"ended by signal {-ran.returncode}: {arguments}\n{ran.stderr}")
        return ran

    def check_sanitizers(self, stderr):
        self.assertFalse(any(word in stderr for word in SANITIZER_WORDS), stderr)

    def succeed(self, *arguments, status=DONE):
        ran = self.run_hemibake(*arguments)
        self.assertEqual(ran.returncode, status, f"{arguments}\n{ran.stderr}")
        return ran

    def bake(self, scene, out, *arguments, status=DONE):
        return self.succeed("bake", scene, "-o", out, *arguments, status=status)


def probes(rows):
    """Bytes of an .hprb file; a row is (position, normal, radiance)."""
    return b"HPRB" + struct.pack("<I", len(rows)) + b"".join(
        struct.pack("<10f", *position, *normal, *radiance, 0.0) for position, normal, radiance in rows
    )


def main():
    # A build log may have told its children to ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    result = unittest.main(module="__main__", exit=False, verbosity=2).result
    # Some versions count a case that is skipped among those that ran, some do not.
    only_skipped = result.skipped and len(result.skipped) >= result.testsRun
    if not result.wasSuccessful() or result.testsRun + len(result.skipped) == 0:
        sys.exit(1)
    sys.exit(77 if only_skipped else 0)
