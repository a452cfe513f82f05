# SPDX-License-Identifier: MIT
"""How does a test of a host run? In a folder of its own, with an installation of this build beside it."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SAMPLES = os.path.join(ROOT, "samples")
sys.path.insert(0, os.path.join(ROOT, "tests/cli"))
from command import main  # noqa: E402, F401  a test of a host ends as one of the command does

BUILD = os.environ.get("HEMIBAKE_BUILD", os.path.join(ROOT, "build/release"))
ROOM = os.path.join(SAMPLES, "pillar-room.glb")

# A hang is a failure; machines are busy.
PATIENCE_S = 300

os.environ.pop("OCIO", None)


class HostCase(unittest.TestCase):
    """Each test starts in an empty folder, self.folder; a space in its name proves that paths are taken whole."""

    maxDiff = None

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="hemibake host ")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def run_program(self, *command, status=0, **popen):
        popen.setdefault("cwd", self.folder)
        ran = subprocess.run(
            [str(word) for word in command],
            stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=PATIENCE_S, **popen,
        )
        if status is not None:
            self.assertEqual(ran.returncode, status, f"{command}\n{ran.stdout}\n{ran.stderr}")
        return ran

    @classmethod
    def install(cls):
        """An installation of the build, removed when the class is done; its folder."""
        prefix = tempfile.mkdtemp(prefix="hemibake prefix ")
        cls.addClassCleanup(shutil.rmtree, prefix)
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], check=True, capture_output=True)
        return prefix
