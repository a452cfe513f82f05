#!/bin/sh
# SPDX-License-Identifier: MIT
# Does a bake hold when the machine around it fails? The long run: sh tests/faults/run.sh [KILLS of each of three scenes]
set -e
cd "$(dirname "$0")/../.."
export HEMIBAKE="${HEMIBAKE:-$PWD/build/release/bin/hemibake}"
export HEMIBAKE_BROKEN_CALLS="${HEMIBAKE_BROKEN_CALLS:-$PWD/build/release/tests/broken_calls.so}"
exec "${HEMIBAKE_PYTHON:-python3}" -B tests/faults/faults.py --kills "${1:-200}" --scenes 3
