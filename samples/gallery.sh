#!/bin/sh
# SPDX-License-Identifier: MIT
# What do the samples look like, and what did they cost? Bakes them and writes a page of pictures and figures.
#
#     sh samples/gallery.sh [FOLDER [bake option ...]]      default: build/gallery
#
# $HEMIBAKE: the command, instead of build/release/bin/hemibake. The USD sample is left out where Python has no usd-core.
set -eu

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
root=$(CDPATH='' cd -- "$here/.." && pwd -P)
mkdir -p "${1:-$root/build/gallery}"
out=$(CDPATH='' cd -- "${1:-$root/build/gallery}" && pwd -P)
[ $# -eq 0 ] || shift
hemibake=${HEMIBAKE:-$root/build/release/bin/hemibake}
python=${HEMIBAKE_USD_PYTHON:-python3}

# bake NAME INPUT CAMERA [option ...]: NAME.glb, .jpg and .json in the folder; no CAMERA: from outside.
bake() {
  name=$1 input=$2 camera=$3
  shift 3
  echo "Baking $name ..."
  "$hemibake" bake "$input" -o "$out/$name.glb" --report "$out/$name.json" -q "$@"
  "$hemibake" render "$out/$name.glb" -o "$out/$name.jpg" --size 960x600 ${camera:+--camera "$camera"}
}

bake pillar-room "$root/samples/pillar-room.glb" '' "$@"
scenes=$root/samples/scenes
python3 "$scenes/interior.py" "$out/interior.in.glb"
bake interior "$out/interior.in.glb" corner --sun 25,32,28000 --environment 11000,12000,14000 "$@"
for study in cornell smooth cage hard; do
  python3 "$scenes/studies.py" $study "$out/$study.in.glb"
done
bake cornell "$out/cornell.in.glb" front "$@"
bake smooth "$out/smooth.in.glb" front "$@"
bake cage "$out/cage.in.glb" front --subdivide 3 --sun 40,32,70000,2 --environment 4000,5000,7000 "$@"
bake hard "$out/hard.in.glb" front "$@"
python3 "$root/samples/pavilion/build.py" -o "$out/pavilion.in.glb"
bake pavilion "$out/pavilion.in.glb" figure-14 "$@"
if "$python" -c 'import pxr' 2>/dev/null; then
  "$python" "$root/samples/usd/hall.py" "$out/hall.in.usda"
  HEMIBAKE_USD_PYTHON=$python bake hall "$out/hall.in.usda" '' "$@"
fi
python3 "$here/gallery.py" "$out"
