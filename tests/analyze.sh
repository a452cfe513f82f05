#!/bin/sh
# SPDX-License-Identifier: MIT
# What do analyzers say of the code? cppcheck, clang-tidy and gcc -fanalyzer over what the preset release compiles; each finding is mended, or
# judged in one line of analyze.txt.
#
#     sh tests/analyze.sh [cppcheck|tidy|gcc ...]     all three, or those that are named
#
# Prints what is not judged, and lines of analyze.txt that no longer meet anything. The exit status is the number of tools with findings.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."
[ $# -gt 0 ] || set -- cppcheck tidy gcc
cmake --preset release >/dev/null
build=$PWD/build/analyze
mkdir -p "$build"
python=${HEMIBAKE_PYTHON:-python3}

# The commands of what is ours and no test.
"$python" -B tests/analyze.py commands build/release/compile_commands.json "$build/compile_commands.json"

run_cppcheck() {
  cppcheck --project="$build/compile_commands.json" --library=tests/analyze.cfg --enable=warning,portability,performance --inline-suppr --quiet -j2 \
    --suppress=missingIncludeSystem --suppress=unmatchedSuppression --suppress='*:/usr/*' --template='{file}:{line}: {id}: {message}'
}

run_tidy() {
  tidy=$(command -v clang-tidy || command -v clang-tidy-19 || command -v clang-tidy-14)
  "$python" -B tests/analyze.py files "$build/compile_commands.json" | xargs -P 2 -n 4 "$tidy" -p "$build" --quiet \
    --checks='-*,clang-analyzer-*,-clang-analyzer-security.insecureAPI.DeprecatedOrUnsafeBufferHandling,bugprone-*,-bugprone-easily-swappable-parameters,-bugprone-reserved-identifier,-bugprone-narrowing-conversions,-bugprone-implicit-widening-of-multiplication-result,-bugprone-macro-parentheses'
}

# Of C alone: gcc 12 does not know C++ well enough.
run_gcc() {
  "$python" -B tests/analyze.py analyze "$build/compile_commands.json"
}

fell=0
for tool in "$@"; do
  if [ "$tool" = cppcheck ] && ! command -v cppcheck >/dev/null || [ "$tool" = tidy ] && ! command -v clang-tidy >/dev/null; then
    echo "$tool: skipped: it is not installed"
    continue
  fi
  "run_$tool" >"$build/$tool.log" 2>&1 || true
  "$python" -B tests/analyze.py judge "$tool" "$build/$tool.log" tests/analyze.txt || fell=$((fell + 1))
done
exit "$fell"
