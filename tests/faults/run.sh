#!/bin/sh
# SPDX-License-Identifier: MIT
# Does a bake hold when the machine around it fails? The long run: sh tests/faults/run.sh [KILLS of each of three scenes [REFUSALS]]
set -e
cd "$(dirname "$0")/../.."
export HEMIBAKE="${HEMIBAKE:-$PWD/build/release/bin/hemibake}"
export HEMIBAKE_BROKEN_CALLS="${HEMIBAKE_BROKEN_CALLS:-$PWD/build/release/tests/broken_calls.so}"
# Every request of the library's own that a host's allocator can refuse; then what the C library is asked for.
allocator="${HEMIBAKE_ALLOCATOR_TEST:-$PWD/build/release/tests/test_api_allocator}"
"$allocator" 1
exec "${HEMIBAKE_PYTHON:-python3}" -B tests/faults/faults.py --kills "${1:-200}" --scenes 3 --refusals "${2:-1000}"
