#!/bin/sh
# SPDX-License-Identifier: MIT
# What does the tolerance of penumbrae buy? Error, time and hemi-cubes over --light-tolerance, on the scenes with probes.
#
#     HEMIBAKE=build/release/bin/hemibake sh tests/bench/light_tolerance.sh
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/../.."
program=${HEMIBAKE:-build/release/bin/hemibake}
truth=tests/accuracy/truth
python=$(sh tests/install-python.sh)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '%-12s %10s %8s %10s %8s\n' scene tolerance error hemi-cubes seconds
for scene in pillar-room cornell-box; do
  for tolerance in 0.5 0.05 0.015 0.005 0.0015 0.0005; do
    "$program" bake "$truth/$scene.glb" -o "$folder/o.glb" --quality medium --light-tolerance "$tolerance" \
      --reference "$truth/$scene.hprb" --report "$folder/r.json" --scene-linear --no-draco --quiet
    "$python" -c 'import json, sys
r = json.load(open(sys.argv[3]))
print("%-12s %10s %7.2f%% %10d %8.2f" % (sys.argv[1], sys.argv[2], 100 * r["error"]["reference"], r["solver"]["hemicubes"], r["time"]["total_s"]))' \
      "$scene" "$tolerance" "$folder/r.json"
  done
done
