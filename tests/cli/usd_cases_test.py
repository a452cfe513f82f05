# SPDX-License-Identifier: MIT
"""Are the stages with known answers, which lie beside the repository, right? Skipped where they are not there.

Baked at high, all of them take minutes: those of a few seconds are run, all with HEMIBAKE_ALL_CASES=1.
"""

import os
import subprocess
import sys
import unittest

from command import HEMIBAKE, ROOT, main
from usd_file import HAS_PXR

CHECK = os.path.join(os.environ.get("HEMIBAKE_SHARED", os.path.join(os.path.dirname(ROOT), "shared")), "usd/check.py")


QUICK = () if os.environ.get("HEMIBAKE_ALL_CASES") else ("01", "10", "14")


@unittest.skipUnless(HAS_PXR, "usd-core cannot be had in the Python of the tests")
@unittest.skipUnless(os.path.exists(CHECK), "../shared/usd/check.py is not there")
class Cases(unittest.TestCase):
    def test_all_are_as_expected(self):
        ran = subprocess.run([sys.executable, CHECK, HEMIBAKE, os.path.dirname(CHECK), *QUICK], capture_output=True, text=True, check=False)
        self.assertEqual(ran.returncode, 0, ran.stdout + ran.stderr)


if __name__ == "__main__":
    main()
