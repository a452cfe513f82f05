# SPDX-License-Identifier: MIT
"""Where may an output go? A file, a link to one, a device, a FIFO, an open file: each as a careful program writes there."""

import json
import os
import shutil
import signal
import stat
import subprocess
import tempfile
import threading
import unittest

import command
import gltf_file
from command import BAD_INPUT, DONE, OUTPUT

GLB = b"glTF"


class Places(command.CommandCase):
    def setUp(self):
        super().setUp()
        self.write("scene.glb", gltf_file.room().glb())

    def draft(self, out, *more, status=DONE):
        return self.bake("scene.glb", out, "--quality", "draft", *more, status=status)

    def mode(self, name):
        return stat.S_IMODE(os.lstat(self.path(name)).st_mode)

    def is_baked(self, name):
        self.assertEqual(self.read(name)[:4], GLB, name)

    # ---- files ---------------------------------------------------------------------------------------------------

    def test_a_new_file_has_the_mode_of_the_umask(self):
        for mask in (0o022, 0o077):
            before = os.umask(mask)
            try:
                self.draft("out.glb")
            finally:
                os.umask(before)
            self.assertEqual(self.mode("out.glb"), 0o666 & ~mask)
            os.remove(self.path("out.glb"))

    def test_a_file_that_is_replaced_keeps_its_mode(self):
        for mode in (0o600, 0o640, 0o666, 0o755):
            self.write("out.glb", b"old")
            self.write("out.json", b"old")
            for name in ("out.glb", "out.json"):
                os.chmod(self.path(name), mode)
            self.draft("out.glb", "--report", "out.json")
            self.is_baked("out.glb")
            self.assertEqual((self.mode("out.glb"), self.mode("out.json")), (mode, mode))

    @unittest.skipUnless(os.geteuid() == 0, "only root gives files away")
    def test_root_replaces_a_file_of_somebody_else_for_them(self):
        self.write("out.glb", b"old")
        os.chown(self.path("out.glb"), 12345, 23456)
        self.draft("out.glb")
        status = os.stat(self.path("out.glb"))
        self.assertEqual((status.st_uid, status.st_gid), (12345, 23456))

    def test_a_link_is_followed(self):
        os.mkdir(self.path("store"))
        self.write("store/real.glb", b"old")
        os.symlink("store/real.glb", self.path("one.glb"))
        os.symlink(self.path("one.glb"), self.path("out.glb"))
        self.draft("out.glb")
        self.assertEqual(os.readlink(self.path("out.glb")), self.path("one.glb"))
        self.assertTrue(os.path.islink(self.path("one.glb")))
        self.is_baked("store/real.glb")
        self.assertEqual(self.left(), ["one.glb", "out.glb", "scene.glb", "store", "store/real.glb"])

    def test_a_link_to_what_is_not_there_yet(self):
        os.mkdir(self.path("store"))
        os.symlink("store/new.glb", self.path("out.glb"))
        self.draft("out.glb")
        self.assertTrue(os.path.islink(self.path("out.glb")))
        self.is_baked("store/new.glb")

    def test_a_link_that_leads_to_itself(self):
        os.symlink("out.glb", self.path("out.glb"))
        ran = self.draft("out.glb", status=OUTPUT)
        self.assertRegex(ran.stderr, r"\Ahemibake: out\.glb: cannot be written: [^\n]+\n\Z")

    def test_hard_links_are_split(self):
        self.write("other.glb", b"old")
        os.link(self.path("other.glb"), self.path("out.glb"))
        self.draft("out.glb")
        self.is_baked("out.glb")
        self.assertEqual(self.read("other.glb"), b"old")

    def test_two_outputs_of_one_name(self):
        os.mkdir(self.path("folder"))
        for name in ("out", "folder/../out", "./out"):
            ran = self.draft("out.glb", "--report", "out", "--preview", name, status=OUTPUT)
            self.assertRegex(ran.stderr, r"\Ahemibake: [^\n]+: another output has this name too\n\Z")
            self.assertEqual(self.left(), ["folder", "scene.glb"])

    def test_a_name_as_long_as_names_may_be(self):
        name = "o" * 251 + ".glb"
        self.draft(name)
        self.is_baked(name)
        ran = self.draft("o" + name, status=OUTPUT)
        self.assertEqual(ran.stderr.count("\n"), 1)

    def test_a_socket_a_folder_and_a_name_that_ends_with_a_slash(self):
        import socket
        with socket.socket(socket.AF_UNIX) as s:
            before = os.getcwd()
            os.chdir(self.folder)
            try:
                s.bind("out.json")
            finally:
                os.chdir(before)
            os.mkdir(self.path("folder"))
            for name, words in (("out.json", "a socket"), ("folder", "a folder"), ("folder/", "a folder"), ("new/", "a folder")):
                ran = self.draft("out.glb", "--report", name, status=OUTPUT)
                self.assertRegex(ran.stderr, r"\Ahemibake: [^\n]+\n\Z")
                self.assertIn(words, ran.stderr)

    # ---- what is no file -----------------------------------------------------------------------------------------

    def device(self, name, minor):
        """A device of memory that is our own: what root replaces by mistake is not the machine's."""
        if os.geteuid() != 0:
            return {"null": "/dev/null", "full": "/dev/full"}[name]
        try:
            os.mknod(self.path(name), 0o666 | stat.S_IFCHR, os.makedev(1, minor))
        except OSError as error:
            self.skipTest(f"no devices here: {error}")
        return self.path(name)

    def test_a_device_is_written_and_stays_one(self):
        null, full = self.device("null", 3), self.device("full", 7)
        self.draft("out.glb", "--report", null)
        self.draft("out.glb", "--report", null, "--preview", null, "--depfile", null)
        self.assertTrue(stat.S_ISCHR(os.stat(null).st_mode))
        ran = self.draft("out.glb", "--report", full, status=OUTPUT)
        self.assertIn("full: cannot be written: No space left", ran.stderr)
        self.assertTrue(stat.S_ISCHR(os.stat(full).st_mode))

    def test_a_fifo_is_written_and_stays_one(self):
        os.mkfifo(self.path("out.json"))
        got = []
        reader = threading.Thread(target=lambda: got.append(self.read("out.json")), daemon=True)
        reader.start()
        self.draft("out.glb", "--report", "out.json")
        reader.join(timeout=5)
        self.assertIn("solver", json.loads(got[0]))
        self.assertTrue(stat.S_ISFIFO(os.lstat(self.path("out.json")).st_mode))

    def test_dev_stdout_is_what_stdout_is(self):
        """A pipe, or a file that is written on where it is. Links of our own lead there as /dev/stdout does."""
        os.symlink("/proc/self/fd/1", self.path("stdout"))
        ran = subprocess.run([command.HEMIBAKE, "bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--quiet",
                              "--report", "stdout"], cwd=self.folder, capture_output=True, timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, DONE, ran.stderr)
        self.assertIn("solver", json.loads(ran.stdout))
        with open(self.path("log"), "wb") as log:
            log.write(b"before\n")
            log.flush()
            subprocess.run([command.HEMIBAKE, "bake", "scene.glb", "-o", "out.glb", "--quality", "draft", "--report",
                            "stdout"], cwd=self.folder, stdout=log, timeout=command.PATIENCE_S, check=True)
        text = self.read("log").decode()
        self.assertTrue(text.startswith("before\n{"), text[:40])
        self.assertIn("baked ", text)

    def test_a_process_substitution_reads_the_report(self):
        if not shutil.which("bash"):
            self.skipTest("no bash")
        subprocess.run(["bash", "-c", 'set -e; "$0" bake scene.glb -o out.glb --quality draft --quiet --report >(cat > copy.json); wait',
                        command.HEMIBAKE], cwd=self.folder, timeout=command.PATIENCE_S, check=True)
        self.assertIn("solver", json.loads(self.read("copy.json")))

    # ---- what is left ---------------------------------------------------------------------------------------------

    STALE = ".hemibake-0123456789abcdef.part"

    def test_nothing_is_made_before_there_is_something_to_write(self):
        scene = self.read("scene.glb")
        bake = subprocess.Popen([command.HEMIBAKE, "bake", os.path.join(command.SAMPLES, "pillar-room.glb"), "-o", "out.glb",
                                 "--element-size", "0.02", "--patch-size", "0.05", "--progress", "json"],
                                cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(bake.wait)
        self.addCleanup(bake.kill)
        bake.stderr.readline()
        self.assertEqual((self.left(), scene), (["scene.glb"], self.read("scene.glb")))
        bake.kill()
        bake.stderr.close()

    def test_what_a_killed_process_left_goes_at_the_next_start(self):
        self.write(self.STALE, b"half")
        kept = [".hemibake-0123456789abcdeg.part", ".hemibake-0123.part", "out.glb.1.part"]
        for name in kept:
            self.write(name, b"somebody's")
        self.draft("out.glb")
        self.assertEqual(self.left(), sorted([*kept, "out.glb", "scene.glb"]))

    def test_what_a_living_process_is_writing_stays(self):
        import fcntl
        with open(self.write(self.STALE, b"half"), "r+b") as f:
            fcntl.flock(f, fcntl.LOCK_EX)
            self.draft("out.glb")
        self.assertEqual(self.left(), [self.STALE, "out.glb", "scene.glb"])

    def test_a_file_of_the_same_process_number_blocks_nobody(self):
        """In containers each process is number 1: what the one before left there is no reason to fail."""
        script = 'for p in $(seq $$ $(($$ + 4))); do : > out.glb.$p.part; done; exec "$0" bake scene.glb -o out.glb --quality draft --quiet'
        ran = subprocess.run(["sh", "-c", script, command.HEMIBAKE], cwd=self.folder, capture_output=True, text=True,
                             timeout=command.PATIENCE_S)
        self.assertEqual(ran.returncode, DONE, ran.stderr)


if __name__ == "__main__":
    command.main()
