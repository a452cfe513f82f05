# SPDX-License-Identifier: MIT
"""Does 'cmake --install' leave something that other projects can build with, shared and static, by CMake and pkg-config?"""

import os
import re
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from host import BUILD, ROOT, HostCase, main

CONSUMER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "consumer")


class Installed(HostCase):
    @classmethod
    def setUpClass(cls):
        cls.prefix = cls.install()

    def find(self, name):
        for at, _, files in os.walk(self.prefix):
            if name in files:
                return os.path.join(at, name)
        self.fail(f"{name} is not installed")

    def version(self):
        return self.run_program(self.find("hemibake"), "--version").stdout.split()[1]

    def check_bake(self, program, **popen):
        version, own, light = self.run_program(program, **popen).stdout.split()
        self.assertEqual((version, own), (self.version(), "42"))
        # The corner of the floor sees 0.139 of the lamp and reflects half of it; a coarse mesh may be a third off.
        self.assertAlmostEqual(float(light), 0.139 / 2, delta=0.139 / 6)

    def build_consumer(self, *arguments):
        build = self.path("build")
        self.run_program("cmake", "-S", CONSUMER, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                         *arguments)
        self.run_program("cmake", "--build", build)
        return build

    def linked(self, program):
        return "libhemibake.so" in self.run_program("readelf", "-d", program).stdout

    def test_the_target_of_bake_sh_builds_all_that_is_installed(self):
        """It ends with how to install, which wants more than the program; a target of its own has it, without the tests."""
        with open(os.path.join(ROOT, "samples/bake.sh")) as f:
            (target,) = re.findall(r"--target (\w+) # all", f.read())
        made = self.run_program("ninja", "-C", BUILD, "-t", "commands", target).stdout
        linked = set()
        for at, _, files in os.walk(BUILD):
            if "cmake_install.cmake" in files:
                with open(os.path.join(at, "cmake_install.cmake")) as f:
                    linked.update(re.findall(rf'"{re.escape(BUILD)}/((?:bin|lib|node)/[^"]*(?:hemibake|\.a|\.so[.\d]*|\.node))"', f.read()))
        self.assertIn("bin/hemibake", linked)
        missing = [name for name in linked if not re.search(rf"(?<!\S){re.escape(name)}(?!\S)", made)]
        self.assertEqual(missing, [])

    def test_a_project_links_the_shared_library(self):
        build = self.build_consumer("-DCONSUMER_KIND=shared")
        self.check_bake(f"{build}/consumer")
        self.assertTrue(self.linked(f"{build}/consumer"))

    def test_a_project_links_the_static_library(self):
        build = self.build_consumer("-DCONSUMER_KIND=static")
        self.check_bake(f"{build}/consumer")
        self.assertFalse(self.linked(f"{build}/consumer"))

    def test_build_shared_libs_chooses_too(self):
        build = self.build_consumer("-DBUILD_SHARED_LIBS=OFF")
        self.assertFalse(self.linked(f"{build}/consumer"))

    def test_a_host_opens_the_library_at_run_time(self):
        build = self.build_consumer("-DCONSUMER_KIND=static")
        library = self.find("libhemibake.so")
        self.assertEqual(self.run_program(f"{build}/dlopen_host", library).stdout.strip(), self.version())
        self.run_program(f"{build}/dlopen_host", self.path("missing.so"), status=1)

    def test_pkg_config_says_how_to_link_both_ways(self):
        # pkg-config escapes no quotes into a shell; a folder without a space keeps this about the flags.
        prefix = "/tmp/hemibake-pc-%d" % os.getpid()
        os.symlink(self.prefix, prefix)
        self.addCleanup(os.unlink, prefix)
        pc = os.path.dirname(self.find("hemibake.pc")).replace(self.prefix, prefix)
        libraries = os.path.dirname(self.find("libhemibake.a")).replace(self.prefix, prefix)
        environment = dict(os.environ, PKG_CONFIG_PATH=pc, LD_LIBRARY_PATH=libraries)
        source = os.path.join(CONSUMER, "consumer.c")

        def flags(*what):
            return self.run_program("pkg-config", *what, "hemibake", env=environment).stdout.split()

        self.run_program("cc", source, "-o", "shared", *flags("--cflags", "--libs"))
        self.check_bake(self.path("shared"), env=environment)
        static = flags("--cflags", "--libs", "--static")
        static[static.index("-lhemibake")] = "-l:libhemibake.a"
        self.run_program("cc", source, "-o", "static", *static)
        self.check_bake(self.path("static"))

    def test_a_wrong_version_is_told_by_cmake(self):
        shutil.copytree(CONSUMER, self.path("newer"))
        lists = self.path("newer", "CMakeLists.txt")
        with open(lists) as f:
            text = f.read()
        with open(lists, "w") as f:
            f.write(text.replace("hemibake 1.0", "hemibake 7.0"))
        ran = self.run_program("cmake", "-S", self.path("newer"), "-B", self.path("b"),
                               f"-DCMAKE_PREFIX_PATH={self.prefix}", status=1)
        self.assertIn('requested version "7.0"', ran.stderr)

    def test_program_manual_and_configuration_are_there(self):
        with open(self.find("hemibake.1")) as f:
            self.assertIn("\\-\\-element\\-size", f.read())
        self.find("hemibake.ocio")


if __name__ == "__main__":
    main()
