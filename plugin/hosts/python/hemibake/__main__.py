# SPDX-License-Identifier: MIT
"""The command hemibake, as `python -m hemibake` and as the script that pip installs: the program of the package takes over."""

from __future__ import annotations

import os
import sys

from . import places
from .errors import LibraryMissing


def main() -> None:
    try:
        program = places.program()
    except LibraryMissing as e:
        sys.exit(f"hemibake: {e}")
    environment = {"HEMIBAKE_USD_PYTHON": sys.executable, **os.environ}
    os.execve(program, ["hemibake", *sys.argv[1:]], environment)


if __name__ == "__main__":
    main()
