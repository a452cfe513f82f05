#!/bin/sh
# SPDX-License-Identifier: MIT
# Do threads race? Builds the preset tsan, runs the tests of what threads share, and bakes of shared scenes on four threads: three small ones
# on both roads, rows at medium, kept rows lit anew, groups of lights, and two that are large enough for what only large ones do (stand-ins,
# triangles merged and colours fitted part by part). What is not ours is in tsan.supp, each with its reason.
#
#     sh tests/tsan.sh [SCENE.glb ...]     draft bakes of other scenes, on both roads
#
# One line a run; the exit status is the number of runs in which a race was found, 77 where nothing could run.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."
root=$(pwd -P)
scenes=$root/../shared/scenes
all=
[ $# -gt 0 ] || all=yes
[ $# -gt 0 ] || set -- "$scenes/living-room.glb" "$scenes/living-room-lamps.glb" "$scenes/slot.glb"
tests="core_jobs core_item_pool core_rows core_kept_rows core_column core_cluster core_methods core_progressive core_factor_matrix
  core_direct_light core_contact_cut core_shading_normals core_refined_gather core_noise_filter core_residual core_vertex_fit core_decimate
  api_bake api_contexts api_relight converters_merge"

cmake --preset tsan -DHEMIBAKE_TESTS=ON >/dev/null
# shellcheck disable=SC2046,SC2086 # lists are split into words on purpose
cmake --build --preset tsan --target hemibake_cli $(printf 'test_%s ' $tests) -- -j2 | tail -n 1

export LP_NUM_THREADS=0
export TSAN_OPTIONS="suppressions='$root/tests/tsan.supp':exitcode=66:second_deadlock_stack=1:ignore_noninstrumented_modules=1"
# Its shadow lies where a kernel that scatters addresses widely may put something else.
flat=
! setarch -R true 2>/dev/null || flat="setarch -R"
log=$(mktemp)
trap 'rm -f "$log" "$log.glb" "$log.rows"' EXIT
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

# bake NAME SCENE OPTION ...: on four threads; a scene that is not there is left out.
bake() {
  name=$1 scene=$2
  shift 2
  [ -f "$scene" ] || return 0
  ran=$((ran + 1))
  run "$(basename "$scene" .glb) $name" build/tsan/bin/hemibake bake "$scene" -o "$log.glb" --threads 4 --quiet "$@"
}

element=${HEMIBAKE_TSAN_ELEMENT:-0.5}
for scene in "$@"; do
  for method in hybrid rows; do
    bake "$method" "$scene" --quality draft --method "$method" --element-size "$element" --patch-size 1.5
  done
done
if [ -n "$all" ]; then
  bake "rows, medium" "$scenes/slot.glb" --method rows --element-size "$element" --vertex-errors
  bake "groups of lights" "$scenes/living-room-lamps.glb" --method rows --quality draft --element-size "$element" --light-groups
  for what in kept "lit anew"; do
    bake "rows, $what" "$scenes/bedroom.glb" --method rows --quality draft --element-size "$element" --rows "$log.rows"
  done
  for scene in garage apartment; do bake "rows, large" "$scenes/$scene.glb" --method rows --quality draft --element-size 2; done
fi
[ "$ran" -gt 0 ] || echo "skipped: the shared scenes are not beside this checkout; only the tests were run"
exit "$fell"
