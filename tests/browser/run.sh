#!/bin/sh
# SPDX-License-Identifier: MIT
# Does a browser show the pixels that OpenColorIO says? Installs what that takes, builds, and asks four viewers.
#
#     sh tests/browser/run.sh [--keep FOLDER]      keeps assets and screenshots there
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/../.."
packages="chromium python3-pyopencolorio"
command -v node >/dev/null 2>&1 || packages="$packages nodejs"
command -v npm >/dev/null 2>&1 || packages="$packages npm"
# shellcheck disable=SC2086 # the list is split into words on purpose
sh samples/install-packages.sh $packages
sh tests/install-modules.sh
HEMIBAKE_PYTHON=$(sh tests/install-python.sh)
export HEMIBAKE_PYTHON
cmake --preset release
cmake --build --preset release --target hemibake_cli -- -j2
exec node tests/browser/viewers.mjs "$@"
