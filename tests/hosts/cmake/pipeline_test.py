# SPDX-License-Identifier: MIT
"""Does a build bake what changed, and nothing else, by Ninja and Make, from an installation and from the source folder?"""

import glob
import os
import shutil
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from host import ROOT, SAMPLES, HostCase, main

PIPELINE = os.path.join(SAMPLES, "asset-pipeline")
COUNT = 20
FEW = 4  # where Ninja has shown that twenty go


class Pipeline(HostCase):
    @classmethod
    def setUpClass(cls):
        cls.prefix = cls.install()

    def outputs(self):
        """When each baked asset was made."""
        return {path: os.stat(path).st_mtime_ns for path in glob.glob(self.path("**/baked/*.glb"), recursive=True)}

    def touch(self, name):
        (path,) = glob.glob(self.path("**/" + name), recursive=True)
        os.utime(path)

    def make_few_assets(self, folder):
        """The last of the pipeline's assets, in a folder."""
        self.run_program(sys.executable, os.path.join(PIPELINE, "assets.py"), folder)
        for path in glob.glob(os.path.join(glob.escape(folder), "*.gltf")):
            if int(path[-7:-5]) <= COUNT - FEW:
                os.unlink(path)

    def check_changes(self, count, build):
        """build() builds; each change bakes again what it must."""
        build()
        first = self.outputs()
        self.assertEqual(len(first), count)
        build()
        self.assertEqual(self.outputs(), first, "a second build does nothing")
        for changed, expected in (("niche-17.bin", 1), ("niche-19.gltf", 1), ("plaster.png", count)):
            before = self.outputs()
            self.touch(changed)
            build()
            after = self.outputs()
            again = [path for path in after if after[path] != before[path]]
            self.assertEqual(len(again), expected, f"{changed} was touched")
            if expected == 1:
                self.assertIn(changed.split(".")[0], again[0])

    def configure_pipeline(self, generator):
        self.run_program("cmake", "-S", PIPELINE, "-B", self.path("build"), "-G", generator,
                         f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DPython3_EXECUTABLE={sys.executable}")

    def check_cmake(self, generator, count):
        self.configure_pipeline(generator)
        self.check_changes(count, lambda: self.run_program("cmake", "--build", self.path("build"), "-j2"))
        self.assertEqual(len(glob.glob(self.path("build/baked/*.json"))), count)

    def test_ninja(self):
        self.check_cmake("Ninja", COUNT)

    def test_makefiles_of_cmake(self):
        self.make_few_assets(self.path("build/assets"))
        self.check_cmake("Unix Makefiles", FEW)

    def test_make_alone(self):
        shutil.copy(os.path.join(PIPELINE, "Makefile"), self.folder)
        self.make_few_assets(self.path("assets"))
        program = glob.glob(os.path.join(self.prefix, "bin/hemibake"))[0]
        os.symlink(program, self.path("hemibake"))
        self.check_changes(FEW, lambda: self.run_program("make", "-j2", "HEMIBAKE=./hemibake"))

    def test_make_alone_makes_its_assets_where_there_are_none(self):
        for name in ("Makefile", "assets.py"):
            shutil.copy(os.path.join(PIPELINE, name), self.folder)
        environment = {**os.environ, "PATH": os.path.dirname(sys.executable) + ":" + os.environ["PATH"]}
        listed = self.run_program("make", "-n", "-C", self.folder, env=environment).stdout
        self.assertEqual(listed.count(" bake assets/niche-"), COUNT, "a clean clone has something to do")
        os.unlink(self.path("assets/niche-05.gltf"))
        listed = self.run_program("make", "-s", "-C", self.folder, "list", env=environment).stdout
        self.assertEqual(len(listed.split()), COUNT - 1, "assets that are there are left alone")

    def test_a_failed_bake_fails_the_build_and_the_others_are_made(self):
        self.make_few_assets(self.path("build/assets"))
        self.configure_pipeline("Ninja")
        with open(self.path("build/assets/niche-18.gltf"), "w") as f:
            f.write("{}")
        ran = self.run_program("ninja", "-C", self.path("build"), "-k0", "-j2", status=1)
        self.assertIn("niche-18.gltf: ", ran.stdout)
        self.assertEqual(len(self.outputs()), FEW - 1)

    def project(self, text):
        with open(self.path("CMakeLists.txt"), "w") as f:
            f.write("cmake_minimum_required(VERSION 3.25)\nproject(host LANGUAGES C CXX)\n" + text)

    def test_the_source_folder_gives_the_same_function(self):
        self.project(f"""
            add_subdirectory({ROOT} hemibake)
            hemibake_bake(TARGET room INPUT {SAMPLES}/pillar-room.glb OUTPUT room.gltf OPTIONS --quality draft)
        """)
        self.run_program("cmake", "-S", self.folder, "-B", self.path("b"), "-G", "Ninja")
        ran = self.run_program("ninja", "-C", self.path("b"), "-n", "-v", "room")
        self.assertRegex(ran.stdout, r"hemibake/bin/hemibake.? bake .*pillar-room\.glb.* --quality draft --threads")
        self.assertNotIn(os.path.join(ROOT, "tests", ""), ran.stdout, "whoever adds the folder does not build its tests")

    def test_wrong_calls_are_told(self):
        for call, word in (
            ("TARGET t OUTPUT b.glb", "INPUT is missing"),
            ("TARGET t INPUT a.glb OUTPUT b.glb --quality high", "options follow OPTIONS"),
            ("TARGET taken INPUT a.glb OUTPUT b.glb", "'taken' is taken"),
        ):
            self.project(f"find_package(hemibake REQUIRED)\nadd_custom_target(taken)\nhemibake_bake({call})")
            ran = self.run_program("cmake", "-S", self.folder, "-B", self.path("b"),
                                   f"-DCMAKE_PREFIX_PATH={self.prefix}", status=1)
            self.assertIn(word, " ".join(ran.stderr.split()))


if __name__ == "__main__":
    main()
