#!/bin/sh
# SPDX-License-Identifier: MIT
# Does every .gltf and .glb that Debian and npm ship bake and validate, or end with one clear line, and is nothing lost?
#
#     sh tests/corpus/run.sh [PART-OF-A-PATH ...]
#
# HEMIBAKE names another command than build/release/bin/hemibake, HEMIBAKE_JOBS how many run at once (2). Ends with a line
# 'N passed, N failed'; exit status 77 without a network to fetch the packages from.
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/../.."
sh tests/corpus/fetch.sh || { echo "run.sh: skipped: not all packages could be fetched" >&2; exit 77; }
mkdir -p build/corpus/node
if ! cmp -s tests/corpus/package.json build/corpus/node/package.json || [ ! -d build/corpus/node/node_modules ]; then
  cp tests/corpus/package.json build/corpus/node/
  (cd build/corpus/node && npm install --no-package-lock --no-audit --no-fund --silent) || {
    rm build/corpus/node/package.json
    echo "run.sh: skipped: npm cannot install what reads the outputs" >&2
    exit 77
  }
fi
cp tests/corpus/readers.mjs build/corpus/node/
exec "$(sh tests/install-python.sh)" -B tests/corpus/corpus.py "$@"
