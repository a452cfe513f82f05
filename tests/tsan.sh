#!/bin/sh
# SPDX-License-Identifier: MIT
# Do threads race? Builds the preset tsan, runs the tests of what threads share, and bakes of three shared scenes on four threads, on both
# roads. What is not ours is in tsan.supp, each with its reason.
#
#     sh tests/tsan.sh [SCENE.glb ...]     other scenes than living-room, living-room-lamps and slot of ../shared/scenes
#
# One line a run; the exit status is the number of runs in which a race was found, 77 where nothing could run.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."
root=$(pwd -P)
scenes=$root/../shared/scenes
[ $# -gt 0 ] || set -- "$scenes/living-room.glb" "$scenes/living-room-lamps.glb" "$scenes/slot.glb"
tests="core_jobs core_item_pool core_rows core_column core_methods core_direct_light"

cmake --preset tsan -DHEMIBAKE_TESTS=ON >/dev/null
# shellcheck disable=SC2046,SC2086 # lists are split into words on purpose
cmake --build --preset tsan --target hemibake_cli $(printf 'test_%s ' $tests) -- -j2 | tail -n 1

export LP_NUM_THREADS=0
export TSAN_OPTIONS="suppressions='$root/tests/tsan.supp':exitcode=66:second_deadlock_stack=1:ignore_noninstrumented_modules=1"
# Its shadow lies where a kernel that scatters addresses widely may put something else.
flat=
! setarch -R true 2>/dev/null || flat="setarch -R"
log=$(mktemp)
trap 'rm -f "$log" "$log.glb"' EXIT
fell=0

# run NAME COMMAND ...: prints what came of it.
run() {
  name=$1 status=0
  shift
  $flat "$@" >"$log" 2>&1 || status=$?
  races=$(grep -c '^WARNING: ThreadSanitizer' "$log") || races=0
  if [ "$races" -gt 0 ] || [ "$status" -ne 0 ]; then
    fell=$((fell + 1))
    grep -E '^WARNING: ThreadSanitizer|^SUMMARY|#[0-3] |hemibake:' "$log" | head -n 12
  fi
  printf '%-44s status %3d, %d races\n' "$name" "$status" "$races"
}

for test in $tests; do run "$test" "build/tsan/tests/test_$test"; done
ran=0
for scene in "$@"; do
  [ -f "$scene" ] || continue
  ran=$((ran + 1))
  for method in hybrid rows; do
    run "$(basename "$scene" .glb) $method" build/tsan/bin/hemibake bake "$scene" -o "$log.glb" --quality draft --method "$method" \
      --threads 4 --element-size "${HEMIBAKE_TSAN_ELEMENT:-0.5}" --patch-size 1.5 --quiet
  done
done
[ "$ran" -gt 0 ] || echo "skipped: the shared scenes are not beside this checkout; only the tests were run"
exit "$fell"
