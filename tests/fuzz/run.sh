#!/bin/sh
# SPDX-License-Identifier: MIT
# Does any input crash, hang or leak a reader? Builds with clang and libFuzzer under AddressSanitizer, runs each target.
#
#     sh tests/fuzz/run.sh SECONDS [TARGET ...]
#
# One table; the exit status is the number of targets with findings. Those lie in build/fuzz/found; what is mended goes into
# tests/fuzz/regressions, named TARGET-WHAT. The corpus stays in build/fuzz/corpus from run to run.
set -eu
seconds=${1:?SECONDS [TARGET ...]}
shift
cd "$(dirname "$0")/../.."
clang=${CLANG:-$(command -v clang-19 || command -v clang-14 || echo clang-19)}
command -v "$clang" >/dev/null || { echo "run.sh: $clang is missing: apt-get install clang-19 libclang-rt-19-dev" >&2; exit 2; }
build=$PWD/build/fuzz
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DHEMIBAKE_TESTS=ON -DHEMIBAKE_FUZZ=ON \
  -DHEMIBAKE_SANITIZE=fuzzer-no-link,address -DCMAKE_C_COMPILER="$clang" -DCMAKE_CXX_COMPILER="$(echo "$clang" | sed 's/clang/clang++/')" >/dev/null
cmake --build "$build" --target fuzz_readers -- -j2 | tail -n 1
baked=${HEMIBAKE:-$PWD/build/release/bin/hemibake}
mkdir -p "$build/found" "$build/baked"
[ ! -x "$baked" ] || "$baked" bake samples/pillar-room.glb -o "$build/baked/pillar.glb" --quality draft --quiet
"${HEMIBAKE_PYTHON:-python3}" -B tests/fuzz/seeds.py "$build/seeds" "$build/baked"/*.glb

[ $# -gt 0 ] || set -- gltf draco meshopt image hdr vs3 hprb ies config scene factor ckpt kept rows bake
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1
LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
export LSAN_OPTIONS
fell=0
printf '%-8s %12s %10s %10s %8s  %s\n' target executions edges features seconds findings
for target in "$@"; do
  mkdir -p "$build/corpus/$target" "$build/seeds/$target"
  for seed in "$build/seeds/$target"-*; do [ ! -f "$seed" ] || cp "$seed" "$build/seeds/$target/"; done
  log=$build/$target.log
  status=0
  HEMIBAKE_FUZZ=$target "$build/tests/fuzz_readers" "$build/corpus/$target" "$build/seeds/$target" -max_total_time="$seconds" -timeout=20 \
    -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 -artifact_prefix="$build/found/$target-" \
    $([ "$target" != config ] || echo "-dict=$PWD/tests/fuzz/ocio.dict") $([ "$target" != gltf ] || echo "-dict=$PWD/tests/fuzz/gltf.dict") >"$log" 2>&1 || status=$?
  last=$(grep -E 'cov: [0-9]+' "$log" | tail -n 1)
  [ "$status" -eq 0 ] || fell=$((fell + 1))
  printf '%-8s %12s %10s %10s %8s  %s\n' "$target" "$(sed -n 's/.*number_of_executed_units: //p' "$log")" \
    "$(echo "$last" | sed -n 's/.*cov: \([0-9]*\).*/\1/p')" "$(echo "$last" | sed -n 's/.*ft: \([0-9]*\).*/\1/p')" "$seconds" \
    "$([ "$status" -eq 0 ] && echo none || grep -m 1 -E 'ERROR|SUMMARY' "$log")"
done
exit "$fell"
