#!/bin/sh
# SPDX-License-Identifier: MIT
# How much faster than Cycles at the same error? Builds, installs Blender where it is missing, and measures both by turns.
#
#     sh tests/bench/speed_error.sh [full|middle|short|tiny] [OPTION ...]
#
# Default: full, more than an hour; middle: a quarter of one; short: minutes; tiny: half a minute.
#
# Options are those of speed_error.py. HEMIBAKE names another command than the one it builds. Exit status 77: skipped,
# there is no Blender to be had.
set -eu

grid=full
case ${1:-} in full | middle | short | tiny) grid=$1 && shift ;; esac
CDPATH='' cd -- "$(dirname -- "$0")/../.."

skip() {
  echo "speed_error.sh: skipped: $*"
  exit 77
}

command -v blender >/dev/null 2>&1 || sh samples/install-packages.sh blender || skip "no Blender, and it cannot be installed"
command -v blender >/dev/null 2>&1 || skip "there is no Blender"
python=${HEMIBAKE_PYTHON:-$(sh tests/install-python.sh)}

if [ -z "${HEMIBAKE:-}" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target hemibake_cli >/dev/null
  HEMIBAKE=build/release/bin/hemibake
fi
exec "$python" -B tests/bench/speed_error.py --grid "$grid" --hemibake "$HEMIBAKE" "$@"
