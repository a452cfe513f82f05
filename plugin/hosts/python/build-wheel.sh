#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds the wheel, which brings the command along, and tries it.
#
#     sh plugin/hosts/python/build-wheel.sh [--try] [FOLDER]      default: build/wheels
#
# --try: in a new environment, with numpy and cffi from where pip takes packages: the command, the module, a bake.
# $HEMIBAKE_BUILD names a build of the tree to take; without it build/release is built.
set -eu

try=
[ "${1:-}" != --try ] || { try=yes; shift; }
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
root=$(CDPATH='' cd -- "$here/../../.." && pwd -P)
mkdir -p "${1:-$root/build/wheels}"
out=$(CDPATH='' cd -- "${1:-$root/build/wheels}" && pwd -P)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [ -z "${HEMIBAKE_BUILD:-}" ]; then
  (cd "$root" && cmake --preset release && cmake --build --preset release --target hemibake_shared hemibake_cli) >&2
  # The page of 'hemibake view'; a wheel without it has all else.
  ! command -v npm >/dev/null 2>&1 || (cd "$root" && cmake --build --preset release --target viewer) >&2
  HEMIBAKE_BUILD=$root/build/release
fi
export HEMIBAKE_BUILD
python3 -m venv "$work/build"
"$work/build/bin/pip" install --quiet 'setuptools>=65' wheel 'cffi>=1.15'
rm -f "$out"/hemibake-*.whl
"$work/build/bin/pip" wheel --quiet --no-deps --no-build-isolation --wheel-dir "$out" "$here"
rm -rf "$here/build" "$here/hemibake.egg-info"
wheel=$(ls "$out"/hemibake-*.whl)
echo "$wheel"
[ -n "$try" ] || exit 0

python3 -m venv "$work/clean"
"$work/clean/bin/pip" install --quiet "$wheel"
cd "$work"
"$work/clean/bin/hemibake" --version
"$work/clean/bin/python" -m hemibake bake "$root/samples/pillar-room.glb" -o "$work/room.glb" --quality draft
"$work/clean/bin/python" -c '
import hemibake, sys
done = hemibake.bake(sys.argv[1], "again.glb", quality="draft")
assert open("again.glb", "rb").read() == open("room.glb", "rb").read(), "the bytes are those of the command"
print("tried: the command, the module and a bake, in a clean environment")
' "$root/samples/pillar-room.glb"
