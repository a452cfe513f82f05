#!/bin/sh
# SPDX-License-Identifier: MIT
# How much faster than Cycles at the same error? Builds, installs Blender where it is missing, and measures both by turns.
#
#     sh tests/bench/speed_error.sh [full|middle|short|tiny] [OPTION ...]
#
# Default: full, more than an hour; middle: a quarter of one; short: minutes; tiny: half a minute.
#
# Options are those of speed_error.py. HEMIBAKE names another command than the one it builds. Exit status 77: skipped, the
# scenes with truth are not beside the checkout or there is no Blender to be had.
set -eu

grid=full
case ${1:-} in full | middle | short | tiny) grid=$1 && shift ;; esac
CDPATH='' cd -- "$(dirname -- "$0")/../.."
truth=../shared/truth

skip() {
  echo "speed_error.sh: skipped: $*"
  exit 77
}

[ -d "$truth" ] || skip "there are no reference scenes in $truth"
if ! command -v blender >/dev/null 2>&1 || ! python3 -c 'import numpy' 2>/dev/null; then
  sh samples/install-packages.sh blender python3-numpy || skip "no Blender or no numpy, and they cannot be installed"
fi
command -v blender >/dev/null 2>&1 || skip "there is no Blender"

if [ -z "${HEMIBAKE:-}" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target hemibake_cli >/dev/null
  HEMIBAKE=build/release/bin/hemibake
fi
exec python3 -B tests/bench/speed_error.py --grid "$grid" --hemibake "$HEMIBAKE" --truth "$truth" "$@"
