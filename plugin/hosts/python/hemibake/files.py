# SPDX-License-Identifier: MIT
"""How is a glTF file baked from Python? By the program, in a process of its own: the same bytes as the command gives, and
nothing that happens there can take the interpreter down."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from . import places
from .errors import Cancelled, DataError, HemibakeError, OutputError, UsageError, WorkerDied

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .bake_options import BakeOptions

Progress = Callable[[float, str], "bool | None"]

NOT_CONVERGED = 4
_ERRORS: dict[int, type[HemibakeError]] = {1: DataError, 2: UsageError, 3: OutputError}


@dataclasses.dataclass(frozen=True)
class Bake:
    """What a bake of a file gives."""

    path: str
    converged: bool  # False: `time` or `error` stopped it; the file is written all the same
    report: dict[str, Any]  # the report of --report
    messages: list[str]  # what was passed over, and other warnings


def _arguments(options: dict[str, Any]) -> list[str]:
    out = []
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is True:
            out.append(flag)
        elif value is not False and value is not None:
            # One word, so that a value that begins with - is no option.
            out.append(f"{flag}={os.fspath(value) if isinstance(value, os.PathLike) else value}")
    return out


def _follow(process: subprocess.Popen[str], progress: Progress | None) -> list[str]:
    """Reads until the program has ended; its lines that are no progress."""
    messages = []
    assert process.stderr
    for line in process.stderr:
        if not line.startswith("{"):
            messages.append(line.rstrip("\n").removeprefix("hemibake: "))
        elif progress:
            at = json.loads(line)
            if progress(at["fraction"], at["stage"]) is False:
                raise Cancelled("cancelled by the progress callback", 143)
    return messages


def _run(command: list[str], progress: Progress | None) -> tuple[int, list[str]]:
    # A session of its own: Ctrl-C reaches Python alone, which then ends the program.
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        errors="replace", start_new_session=True, env={"LP_NUM_THREADS": "0", "HEMIBAKE_USD_PYTHON": sys.executable, **os.environ},
    )
    try:
        messages = _follow(process, progress)
        return process.wait(), messages
    finally:
        # Whatever the callback raised: the program ends and leaves nothing behind.
        if process.poll() is None:
            process.terminate()
            process.wait()
        if process.stderr:
            process.stderr.close()


def bake(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    progress: Progress | None = None,
    **options: Unpack[BakeOptions],
) -> Bake:
    """Bakes the glTF asset or USD stage at path into out (.glb, .gltf, .usda, .usdc or .usdz); USD needs usd-core in this Python.

    options: those of 'hemibake bake', with _ for -: quality="high", element_size=0.1, scene_linear=True.
    progress(fraction, stage) is called ten times a second at most; False cancels, and what it raises comes out of here.
    """
    program = places.program()
    name = os.fspath(path)
    if name.startswith("-"):
        name = os.path.join(".", name)  # no option
    with tempfile.TemporaryDirectory(prefix="hemibake-") as folder:
        named = options.get("report")
        report = os.fspath(named) if named else os.path.join(folder, "report.json")
        arguments = _arguments({**options, "report": report})
        command = [program, "bake", "-o", os.fspath(out), "--progress", "json", *arguments, name]
        status, messages = _run(command, progress)
        if status in (0, NOT_CONVERGED):
            with open(report) as f:
                return Bake(os.fspath(out), status == 0, json.load(f), messages)
    text = messages[-1] if messages else f"{program} ended with status {status}"
    if status < 0:
        raise WorkerDied(f"{program} was ended by signal {-status}", status)
    raise _ERRORS.get(status, HemibakeError)(text, status)
