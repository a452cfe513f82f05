#!/bin/sh
# SPDX-License-Identifier: MIT
# How do time and memory grow with elements, input triangles, patches, lamps and threads? Builds, measures, fits exponents.
#
#     sh tests/bench/scaling.sh [full|short|tiny] [OPTION ...]      default: full, up to an hour; tiny: half a minute
#
# Options are those of scaling.py, for example --only lamps. HEMIBAKE names another command than the one it builds.
set -eu

grid=full
case ${1:-} in full | short | tiny) grid=$1 && shift ;; esac
CDPATH='' cd -- "$(dirname -- "$0")/../.."
python=$(sh tests/install-python.sh)
if [ -z "${HEMIBAKE:-}" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target hemibake_cli >/dev/null
  HEMIBAKE=build/release/bin/hemibake
fi
exec "$python" -B tests/bench/scaling.py --grid "$grid" --hemibake "$HEMIBAKE" "$@"
