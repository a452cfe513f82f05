# SPDX-License-Identifier: MIT
"""What can go wrong? Each error carries the text of the library or of the program."""

from __future__ import annotations


class HemibakeError(Exception):
    """Any failure; `result` is the library's code ("HEMI_ERROR_DATA") or the program's exit status."""

    def __init__(self, text: str, result: str | int | None = None) -> None:
        super().__init__(text)
        self.result = result


class DataError(HemibakeError):
    """The scene or the file cannot be baked."""


class UsageError(HemibakeError, ValueError):
    """An option or an argument that there is not, or with a value that it does not take."""


class OutputError(HemibakeError):
    """An output could not be written."""


class Cancelled(HemibakeError):
    """The progress callback returned False."""


class WorkerDied(HemibakeError):
    """The program was killed, or crashed."""


class LibraryMissing(HemibakeError, ImportError):
    """libhemibake or the program is not there, or of another version."""
