# SPDX-License-Identifier: MIT
"""Does 'view' serve a page and what it shows, to this machine alone, and say what is missing? How it looks: tests/browser/viewer.mjs."""

import http.client
import json
import os
import shutil
import signal
import struct
import subprocess

from command import BAD_INPUT, HEMIBAKE, CommandCase, main
from gltf_file import room


class View(CommandCase):
    def setUp(self):
        """The program apart from what was built, with a page beside it."""
        super().setUp()
        os.makedirs(self.path("bin"))
        os.makedirs(self.path("share/hemibake/viewer"))
        shutil.copy(HEMIBAKE, self.path("bin/hemibake"))
        self.write("share/hemibake/viewer/index.html", b"<p>the page</p>")
        self.write("share/hemibake/viewer/viewer.js", b"0")
        self.write("a room.glb", room().glb())
        self.bake("a room.glb", "baked.glb", "--quality", "draft", "--scene-linear")

    def start(self, *arguments):
        """Port of the page, which ends with the test."""
        server = subprocess.Popen([self.path("bin/hemibake"), "view", "baked.glb", *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, text=True)
        self.addCleanup(server.communicate)
        self.addCleanup(server.kill)
        line = server.stdout.readline()
        self.assertRegex(line, r"^http://127\.0\.0\.1:\d+/ shows baked\.glb; Ctrl-C ends it$")
        self.server = server
        return int(line.split(":")[2].split("/")[0])

    def get(self, port, path, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        connection.request("GET", path, headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.read()

    def test_the_page_in_pythons_package_is_found(self):
        shutil.move(self.path("share/hemibake/viewer"), self.path("viewer"))
        self.assertEqual(self.get(self.start(), "/"), (200, b"<p>the page</p>"))

    def test_the_page_gets_what_it_shows(self):
        port = self.start("--before", "a room.glb", "--reference", "baked.glb")
        self.assertEqual(self.get(port, "/"), (200, b"<p>the page</p>"))
        config = json.loads(self.get(port, "/config.json")[1])
        self.assertEqual(config, {"out": "out/baked.glb", "before": "before/a%20room.glb", "error": "error.bin"})
        self.assertEqual(self.get(port, "/" + config["out"]), (200, self.read("baked.glb")))
        self.assertEqual(self.get(port, "/" + config["before"]), (200, self.read("a room.glb")))
        errors = self.get(port, "/" + config["error"])[1]
        self.assertEqual(len(errors) % 28, 4)
        self.assertLess(max(struct.unpack(f"<{len(errors) // 4}f", errors)[7::7]), 1e-4, "a bake is not off from itself")
        self.server.send_signal(signal.SIGINT)
        self.assertEqual((self.server.wait(60), self.server.stderr.read()), (-signal.SIGINT, ""))

    def test_nothing_else_is_served(self):
        port = self.start()
        os.symlink("/etc/passwd", self.path("share/hemibake/viewer/link.txt"))
        for path in ("/error.bin", "/share", "/out/../../etc/passwd", "/out/%2e%2e/x", "/link.txt", "/out/", "/%00"):
            self.assertIn(self.get(port, path)[0], (400, 404), path)
        self.assertEqual(self.get(port, "/", Host="example.org")[0], 403)

    def test_what_is_missing_is_one_line(self):
        self.write("bad.glb", b"glTF")
        for arguments, word in ((("nowhere.glb",), "nowhere.glb"), (("baked.glb", "--before", "bad.glb"), "bad.glb"),
                                (("baked.glb", "--reference", "a room.glb"), "no mesh has _RADIOSITY")):
            ran = self.run_hemibake("view", *arguments)
            self.assertEqual((ran.returncode, len(ran.stderr.splitlines())), (BAD_INPUT, 1), ran.stderr)
            self.assertIn(word, ran.stderr)
        shutil.rmtree(self.path("share"))
        ran = subprocess.run([self.path("bin/hemibake"), "view", "baked.glb"], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(ran.returncode, BAD_INPUT)
        self.assertIn("needs npm", ran.stderr)


if __name__ == "__main__":
    main()
