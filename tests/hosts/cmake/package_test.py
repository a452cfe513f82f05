# SPDX-License-Identifier: MIT
"""Is there a package of Debian that has all of hemibake, says what it needs, and runs from where it was unpacked?"""

import glob
import os
import re
import shutil
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from host import BUILD, ROOT, HostCase, main

TOOLS = ("cpack", "dpkg-deb", "dpkg-shlibdeps")


@unittest.skipUnless(all(map(shutil.which, TOOLS)), "no cpack, or no tools of Debian's packages")
class Package(HostCase):
    def make(self):
        self.run_program("cpack", "-G", "DEB", "--config", os.path.join(BUILD, "CPackConfig.cmake"), "-B", self.path("made"))
        found = glob.glob(self.path("made/hemibake_*.deb"))
        self.assertEqual(len(found), 1, found)
        return found[0]

    def test_it_says_what_it_needs_and_runs(self):
        package = self.make()
        self.assertRegex(os.path.basename(package), r"\Ahemibake_\d+\.\d+\.\d+_\w+\.deb\Z")
        needs = self.run_program("dpkg-deb", "-f", package, "Depends").stdout
        for name in ("libosmesa6", "libdraco", "libtinygltf", "libopencolorio", "libosdcpu", "libc6"):
            self.assertIn(name, needs)
        self.run_program("dpkg-deb", "-x", package, self.path("root"))
        program = self.path("root/usr/bin/hemibake")
        version = re.search(r"_(\d+\.\d+\.\d+)_", package).group(1)
        self.assertEqual(self.run_program(program, "--version").stdout, f"hemibake {version}\n")
        self.run_program(program, "bake", os.path.join(ROOT, "samples/pillar-room.glb"), "-o", self.path("out.glb"), "--quality", "draft")
        self.assertGreater(os.path.getsize(self.path("out.glb")), 10000)
        for name in ("usr/share/man/man1/hemibake.1", "usr/share/hemibake/report.schema.json", "usr/share/doc/hemibake/copyright", "usr/include/hemibake/hemibake.h",
                     "usr/share/zsh/vendor-completions/_hemibake", "usr/share/bash-completion/completions/hemibake"):
            self.assertTrue(glob.glob(self.path("root/" + name + "*")), name)


if __name__ == "__main__":
    main()
