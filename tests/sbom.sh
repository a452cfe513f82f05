#!/bin/sh
# SPDX-License-Identifier: MIT
# What is in what we ship, of which version and under which licence? An SPDX document of the files (by FSFE's reuse), and one of the libraries
# that the command and the library load (by spdx-tools, which also validates it); and a table of these.
#
#     sh tests/sbom.sh [FOLDER]        default: build/sbom: hemibake.spdx, libraries.spdx.json, libraries.md
#
# Exit status 1 where a file or a library has no licence, or a document is not valid; 77 where the tools cannot be installed.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."
out=${1:-build/sbom}
mkdir -p "$out"
tools=$PWD/build/tests/sbom
if [ ! -x "$tools/bin/reuse" ]; then
  python3 -m venv "$tools"
  "$tools/bin/pip" install --quiet 'reuse>=5' 'spdx-tools>=0.8' || { echo "sbom.sh: skipped: pip cannot install reuse and spdx-tools"; exit 77; }
fi
"$tools/bin/reuse" spdx --output "$out/hemibake.spdx"
"$tools/bin/python" -B tests/sbom.py "$out" build/release/bin/hemibake
