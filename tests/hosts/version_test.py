# SPDX-License-Identifier: MIT
"""Does everything that says a version say the header's?"""

import ast
import email
import json
import os
import re
import subprocess
import sys
import zipfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from host import BUILD, ROOT, HostCase, main

HOSTS = os.path.join(ROOT, "plugin/hosts")


def read(*path):
    with open(os.path.join(*path)) as f:
        return f.read()


class Versions(HostCase):
    @classmethod
    def setUpClass(cls):
        cls.prefix = cls.install()
        header = read(ROOT, "plugin/include/hemibake/hemibake.h")
        cls.version = re.search(r'^#define HEMI_VERSION_STRING "([\d.]+)"', header, re.M).group(1)

    def installed(self, name):
        found = [os.path.join(at, name) for at, _, files in os.walk(self.prefix) if name in files]
        self.assertTrue(found, f"{name} is not installed")
        return found[0]

    def test_it_is_three_numbers(self):
        self.assertRegex(self.version, r"^\d+\.\d+\.\d+$")

    def test_the_program(self):
        self.assertEqual(self.run_program(self.installed("hemibake"), "--version").stdout.split()[1], self.version)

    def test_the_shared_library_is_named_by_its_major_version(self):
        library = os.path.realpath(self.installed("libhemibake.so"))
        self.assertTrue(library.endswith(f"libhemibake.so.{self.version}"), library)
        soname = re.search(r"SONAME.*\[(.*)\]", self.run_program("readelf", "-d", library).stdout).group(1)
        self.assertEqual(soname, f"libhemibake.so.{self.version.split('.')[0]}")
        self.assertIn(f'"{soname}"', read(HOSTS, "python/hemibake/places.py"))

    def test_cmake_and_pkg_config(self):
        cmake = read(self.installed("hemibakeConfigVersion.cmake"))
        self.assertEqual(re.search(r'PACKAGE_VERSION "([\d.]+)"', cmake).group(1), self.version)
        pc = read(self.installed("hemibake.pc"))
        self.assertEqual(re.search(r"^Version: (.*)$", pc, re.M).group(1), self.version)

    def test_the_man_page(self):
        self.assertIn(f'"hemibake {self.version}"', read(self.installed("hemibake.1")).splitlines()[0])

    def test_the_npm_package(self):
        self.assertEqual(json.loads(read(HOSTS, "gltf-transform/package.json"))["version"], self.version)

    def test_the_blender_add_on(self):
        for node in ast.parse(read(HOSTS, "blender/hemibake/__init__.py")).body:
            if isinstance(node, ast.Assign) and node.targets[0].id == "bl_info":
                version = ast.literal_eval(node.value)["version"]
        self.assertEqual(".".join(map(str, version)), self.version)

    def test_the_python_package(self):
        setup = [sys.executable, "setup.py", "--quiet", "egg_info", "--egg-base", self.folder]
        subprocess.run(setup, cwd=os.path.join(HOSTS, "python"), check=True, capture_output=True,
                       env=dict(os.environ, HEMIBAKE_BUILD=BUILD))
        info = email.message_from_string(read(self.folder, "hemibake.egg-info/PKG-INFO"))
        self.assertEqual(info["Version"], self.version)

    def test_the_changelog_begins_with_it(self):
        self.assertIn(f"\n## {self.version}", read(ROOT, "CHANGELOG.md")[:40])

    def test_the_extension_of_blender(self):
        path = self.path("extension.zip")
        self.run_program("sh", os.path.join(HOSTS, "blender/build-extension.sh"), path)
        with zipfile.ZipFile(path) as packed:
            manifest = packed.read("hemibake/blender_manifest.toml").decode()
            names = set(packed.namelist())
        self.assertEqual(names, {"hemibake/" + name for name in os.listdir(os.path.join(HOSTS, "blender/hemibake")) if name != "__pycache__"})
        fields = dict(re.findall(r'^(\w+) = "(.*)"$', manifest, re.M))
        self.assertEqual(fields["version"], self.version)
        for key in ("schema_version", "id", "name", "tagline", "maintainer", "type", "blender_version_min"):
            self.assertIn(key, fields, "Blender asks for it")
        self.assertLessEqual(len(fields["tagline"]), 64)
        self.assertRegex(fields["tagline"], r"\w$")


if __name__ == "__main__":
    main()
