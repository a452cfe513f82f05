# SPDX-License-Identifier: MIT
"""Where are the library and the program? What the environment names, what the wheel holds, what is installed."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from .errors import LibraryMissing

HERE = Path(__file__).parent


def program() -> str:
    """$HEMIBAKE, the program in the package, or the first on PATH."""
    named = os.environ.get("HEMIBAKE")
    inside = HERE / "bin" / "hemibake"
    found = named or (str(inside) if inside.is_file() else shutil.which("hemibake"))
    if not found or not os.access(found, os.X_OK):
        raise LibraryMissing(f"the program hemibake is not at {found or 'any place of PATH'}; install it, or set HEMIBAKE")
    return found


def libraries() -> list[str]:
    """What may be opened, in order."""
    named = os.environ.get("HEMIBAKE_LIBRARY")
    if named:
        return [named]
    return [*map(str, sorted((HERE / "lib").glob("libhemibake.so*"))), "libhemibake.so.1", "libhemibake.so"]
