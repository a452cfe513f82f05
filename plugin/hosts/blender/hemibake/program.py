# SPDX-License-Identifier: MIT
"""How does the program run beside Blender? A process, whose words of progress a thread collects."""

import json
import os
import subprocess
import threading

NOT_CONVERGED = 4


class Run:
    """A bake that is under way."""

    def __init__(self, program, source, output, options):
        self.fraction, self.stage, self.messages = 0.0, "", []
        self._process = subprocess.Popen(
            [program, "bake", source, "-o", output, "--progress", "json", *options],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace",
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self._process.stderr:
            if line.startswith("{"):
                at = json.loads(line)
                self.fraction, self.stage = at["fraction"], at["stage"]
            else:
                self.messages.append(line.strip().replace("hemibake: ", "", 1))

    def is_over(self):
        return self._process.poll() is not None and not self._reader.is_alive()

    def wait(self, seconds=None):
        """Until it is over, or for so long."""
        self._reader.join(seconds)
        if not self._reader.is_alive():
            self._process.wait()

    def cancel(self):
        """The program leaves nothing behind."""
        if self._process.poll() is None:
            self._process.terminate()
        self.wait()

    def fault(self):
        """Why it failed, or None."""
        status = self._process.returncode
        if status in (0, NOT_CONVERGED):
            return None
        if status < 0:
            return f"hemibake was ended by signal {-status}"
        return self.messages[-1] if self.messages else f"hemibake ended with status {status}"

    def stopped_early(self):
        return self._process.returncode == NOT_CONVERGED


def bake_in_place(program, path, options, listen):
    """Bakes the file at path into itself, as a whole or not at all; listen(fraction) meanwhile. Returns the run."""
    stem, end = os.path.splitext(path)
    in_itself = end.lower() == ".gltf"
    run = Run(program, path, path if in_itself else f"{stem}.baking{end}", [*options, *(["--force"] if in_itself else [])])
    while not run.is_over():
        run.wait(0.1)
        listen(run.fraction)
    if run.fault() is None and end.lower() != ".gltf":
        os.replace(f"{stem}.baking{end}", path)
    return run
