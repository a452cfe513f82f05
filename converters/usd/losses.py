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

    def add(self, where: Any, text: str) -> None:
        """where: a prim, a path or a layer's name."""
        path = where.GetPath() if hasattr(where, "GetPath") else where
        self._lines[one_line(f"{path}: {text}")] = None

    def lines(self) -> list[str]:
        return list(self._lines)

    def print(self, to: TextIO) -> None:
        for line in self._lines:
            print(f"warning: {line}", file=to)


def one_line(text: str) -> str:
    return " ".join(str(text).split())


def print_error(text: str, to: TextIO = sys.stderr) -> None:
    print(f"error: {one_line(text)}", file=to)
