#!/bin/sh
# SPDX-License-Identifier: MIT
# What does accuracy cost? Error against seconds of each quality preset, as a Markdown table with commit and machine: the two samples
# with truth, and the scenes of ../shared where it is there.
#
#     sh tests/bench/quality.sh [RUNS [QUALITY ...]]      default: 3 draft medium high reference
#
# Seconds are the median of RUNS bakes.
set -eu

runs=${1:-3}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- draft medium high reference
CDPATH='' cd -- "$(dirname -- "$0")/../.."
truth=tests/accuracy/truth
python=$(sh tests/install-python.sh)
hemibake=build/release/bin/hemibake

cmake --preset release >/dev/null
cmake --build --preset release --target hemibake_cli >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

dirty=$(git status --porcelain --untracked-files=no 2>/dev/null | head -n 1)
echo "$("$hemibake" --version), commit $(git rev-parse --short HEAD 2>/dev/null || echo unknown)${dirty:+ with changes};" \
  "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(nproc) cores; median of $runs runs"
echo
echo "| scene | quality | surfaces | elements | error | median | estimate | seconds | memory |"
echo "|---|---|---:|---:|---:|---:|---:|---:|---:|"

# A row from the reports of all runs and the comparison of the last.
row() {
  "$python" - "$@" <<'PYTHON'
import json, statistics, sys
scene, quality, compared, *reports = sys.argv[1:]
reports = [json.load(open(name)) for name in reports]
last, seconds = reports[-1], statistics.median(r["time"]["total_s"] for r in reports)
compared = json.load(open(compared))
print(f"| {scene} | {quality} | {last['scene']['surfaces']:,} | {last['scene']['elements']:,} "
      f"| {compared['error']:.2%} | {compared['probe_error_median']:.2%} | {last['error']['estimate']:.2%} | {seconds:.2f} "
      f"| {last['memory']['peak_bytes'] / 2**20:.0f} MiB |")
PYTHON
}

# The scenes that are lit by nothing of their own stand under an even sky, as their truth does.
for input in "$truth"/pillar-room.glb "$truth"/cornell-box.glb ../shared/scenes/*.glb; do
  scene=$(basename "$input" .glb)
  probes=${input%.glb}.hprb
  [ -e "$probes" ] || continue
  case $scene in
    living-room | bedroom | garage | zdm2 | apartment) sky="--environment 1,1,1" ;;
    *) sky= ;;
  esac
  for quality in "$@"; do
    rm -f "$folder"/*
    run=0
    while [ "$run" -lt "$runs" ]; do
      run=$((run + 1))
      # shellcheck disable=SC2086 # two words or none
      "$hemibake" bake "$input" -o "$folder/out.glb" --scene-linear --no-draco --quality "$quality" --quiet $sky \
        --report "$folder/report.$run.json"
    done
    "$hemibake" compare "$folder/out.glb" "$probes" --json >"$folder/compared"
    row "$scene" "$quality" "$folder/compared" "$folder"/report.*.json
  done
done
