# SPDX-License-Identifier: MIT
"""Which tests were skipped, whole or in part, and why? Reads what CTest wrote with --output-junit; prints one line a reason.

    python3 tests/skips.py BUILD/tests.xml ...

A test that exits 77 says why in a line 'skipped: ...'; unittest says it of each of its cases. Exit status 1: one did not say.
"""

import collections
import os
import re
import sys
import xml.etree.ElementTree

# A case of unittest, and a whole program. PROGRAM: 'skipped: why' or 'name: skipped: why' on a line of its own.
CASE = re.compile(r"\.\.\. skipped (?P<quote>['\"])(.*)(?P=quote)$", re.MULTILINE)
PROGRAM = re.compile(r"^(?:[\w.-]+: )?skipped: (.*)$", re.MULTILINE)


def reasons(path):
    """(name, is it skipped whole, counted reasons) of each test that was skipped or skipped some of its cases."""
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        text = case.findtext("system-out") or ""
        found = collections.Counter([why for _, why in CASE.findall(text)] + PROGRAM.findall(text))
        whole = case.find("skipped") is not None or case.get("status") in ("notrun", "disabled")
        if whole or found:
            yield case.get("name"), whole, found


def main():
    silent = False
    for path in sys.argv[1:]:
        build = os.path.basename(os.path.dirname(os.path.abspath(path)))
        for name, whole, found in reasons(path):
            if whole and not found:
                silent = True
                found = {"it does not say why, and has to": 1}
            for why, count in found.items():
                part = "" if whole else f", {count} of its cases" if count > 1 else ", one of its cases"
                print(f"skipped: {name} ({build}{part}): {why}")
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())
