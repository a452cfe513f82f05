#!/bin/sh
# SPDX-License-Identifier: MIT
# Would the tests notice? Breaks the code on purpose, one line at a time as tests/mutations.txt lists, in a copy of the tree, and
# runs the tests that should notice. Half an hour on two cores; exit status 1 unless every mutation was noticed.
#
#     sh tests/mutations.sh [NAME ...]     all of them, or those whose names begin so
#     sh tests/mutations.sh --list         nothing is built; prints the list as a table
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/.."
HEMIBAKE_PYTHON=${HEMIBAKE_PYTHON:-$(sh tests/install-python.sh)}
export HEMIBAKE_PYTHON # the copy's tests run on it too
exec "$HEMIBAKE_PYTHON" -B tests/mutations.py "$@"
