#!/bin/sh
# SPDX-License-Identifier: MIT
# Does a whole bake read what was never written, or lose memory? Valgrind's memcheck on a small bake, end to end, on both roads.
#
#     sh tests/memcheck.sh [HEMIBAKE]
#
# Findings in memory of Mesa, LLVM and Embree themselves are left out by memcheck.supp. The exit status is the number of bakes with findings;
# 77: there is no valgrind.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."
hemibake=${1:-build/release/bin/hemibake}
command -v valgrind >/dev/null || { echo "skipped: there is no valgrind"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
(cd tests/bench && "${HEMIBAKE_PYTHON:-$(sh ../install-python.sh)}" -B -c "from small_room import small_room; small_room('$folder/room.glb')")
fell=0
for method in hybrid rows; do
  status=0
  LP_NUM_THREADS=0 valgrind --quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite \
    --suppressions=tests/memcheck.supp --log-file="$folder/$method.log" "$hemibake" bake "$folder/room.glb" -o "$folder/out.glb" \
    --method "$method" --quality draft --element-size 0.6 --patch-size 1.2 --threads 2 --quiet --report "$folder/report.json" \
    --preview "$folder/preview.png" || status=$?
  printf '%-8s status %d\n' "$method" "$status"
  [ "$status" -eq 0 ] && continue
  fell=$((fell + 1))
  head -n 40 "$folder/$method.log"
done
exit "$fell"
