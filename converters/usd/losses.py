# SPDX-License-Identifier: MIT
"""What of a stage does the bake not show? One line a loss, with the path of the prim; each line once."""

from __future__ import annotations

import sys
from typing import Any, TextIO


class Refused(Exception):
    """The stage cannot be baked at all; the text is one line."""


class Losses:
    """Lines in the order they were found."""

    def __init__(self) -> None:
        self._lines: dict[str, None] = {}
        self._uncomposed: dict[str, None] = {}  # of these, what other layers would have brought

    def add(self, where: Any, text: str) -> str:
        """where: a prim, a path or a layer's name. The line."""
        path = where.GetPath() if hasattr(where, "GetPath") else where
        line = one_line(f"{path}: {text}")
        self._lines[line] = None
        return line

    def add_uncomposed(self, where: Any, text: str) -> None:
        self._uncomposed[self.add(where, text)] = None

    def lines(self) -> list[str]:
        return list(self._lines)

    def cause(self) -> str:
        """Why nothing is left, as far as it has been told: its first line, and how many there are more."""
        told = [line for line in self._lines if "not baked" in line] or list(self._uncomposed)
        return told[0] + (f"; and {len(told) - 1} more" if len(told) > 1 else "") if told else ""

    def print(self, to: TextIO) -> None:
        for line in self._lines:
            print(f"warning: {line}", file=to)


def one_line(text: str) -> str:
    return " ".join(str(text).split())


def print_error(text: str, to: TextIO = sys.stderr) -> None:
    print(f"error: {one_line(text)}", file=to)
