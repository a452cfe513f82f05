#!/bin/sh
# SPDX-License-Identifier: MIT
# Does the tree keep its own rules? One table of figures and bounds; exit status 1: one does not hold. Nothing is built for it.
#
#     sh tests/house.sh [--list] [FOLDER]      --list names each offender; FOLDER: another checkout, instead of this one
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/.."
# Any Python will do, since only its standard library is used.
for python in "${HEMIBAKE_PYTHON:-}" python3 /usr/bin/python3 build/tests/python/bin/python3; do
  [ -n "$python" ] && "$python" -c '' >/dev/null 2>&1 && exec "$python" -B tests/house.py "$@"
done
echo "house.sh: there is no python3" >&2
exit 2
