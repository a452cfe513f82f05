#!/bin/sh
# SPDX-License-Identifier: MIT
# Which npm packages do the tests use? Those of package.json, in the versions of the lock beside it, put into build/tests.
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/.."
cmp -s tests/package-lock.json build/tests/package-lock.json && [ -d build/tests/node_modules ] && exit 0
mkdir -p build/tests
cp tests/package.json tests/package-lock.json build/tests/
cd build/tests
npm ci --no-audit --no-fund || { rm package-lock.json; exit 1; }
