#!/bin/sh
# SPDX-License-Identifier: MIT
# How does a newcomer see hemibake work? Installs what is missing, builds, bakes the sample room.
#
#     sh samples/bake.sh
#
# The first run takes minutes, later ones seconds. Results lie in build/samples.
set -eu

started_in=$(pwd -P)
CDPATH='' cd -- "$(dirname -- "$0")/.."
root=$(pwd -P)
out=build/samples
[ "$started_in" = "$root" ] || out=$root/$out # names that are right where the user stands
mkdir -p "$out"

# Runs a step of the build; shows what it said only if it fails.
step() {
  "$@" >"$out/build.log" 2>&1 && return
  cat "$out/build.log" >&2
  echo "bake.sh: '$*' failed; what it said is above" >&2
  exit 1
}

sh samples/install-packages.sh
[ -x build/release/bin/hemibake ] || echo "Building hemibake (minutes, the first time) ..."
step cmake --preset release
step cmake --build --preset release --target installed # all that 'cmake --install' wants

echo "Baking samples/pillar-room.glb ..."
build/release/bin/hemibake bake samples/pillar-room.glb -o "$out/pillar-room.baked.glb" \
  --report "$out/pillar-room.json" --preview "$out/pillar-room.png"
# The page of 'hemibake view' and the plots of reports take npm; without it all else works.
if command -v npm >/dev/null 2>&1; then
  cmake --build --preset release --target viewer >"$out/build.log" 2>&1 || echo "bake.sh: no viewer; $out/build.log says why" >&2
else
  echo "bake.sh: no npm, so 'hemibake view' has no page, and reports have tables where they would have plots (apt install npm, and again)" >&2
fi
cat <<EOF

Look at it:  $out/pillar-room.png, or open $out/pillar-room.baked.glb in any glTF viewer;
             build/release/bin/hemibake view $out/pillar-room.baked.glb --before samples/pillar-room.glb
             build/release/bin/hemibake bake IN.glb -o OUT.glb --report OUT.html shows one of yours before and after
Install it:  cmake --install build/release --prefix /usr/local   (or --prefix "\$HOME/.local", without root)
EOF
