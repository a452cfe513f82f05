#!/bin/sh
# SPDX-License-Identifier: MIT
# Does everything work? Installs what the tests need, builds, runs every test, and the quick ones again under sanitizers.
#
#     sh tests/run.sh [--all]       --all: slow ones under sanitizers too
#
# Ends with what was skipped and why, and a line 'N passed, N failed', over both builds. Exit status 0: none failed, and whatever
# was skipped says why.
set -eu

case ${1:-} in
  '') exclude='--label-exclude slow' ;;
  --all) exclude= ;;
  *) echo "run.sh: what is '$1'? usage: sh tests/run.sh [--all]" >&2; exit 2 ;;
esac

CDPATH='' cd -- "$(dirname -- "$0")/.."
root=$(pwd -P)

# ---- what the tests need ------------------------------------------------------------------------------------------

node_is_new_enough() {
  command -v node >/dev/null 2>&1 && [ "$(node -p 'process.versions.node.split(".")[0]')" -ge 18 ]
}

# The second back end of item buffers wants a driver to open; tests/browser wants a browser and OpenColorIO's own word,
# tests/oracle Embree, cli.processes Open MPI.
packages="python3 python3-cffi python3-numpy python3-pip python3-pytest python3-setuptools python3-venv python3-wheel mypy
  slurm-wlm munge blender libegl-mesa0 libgl1-mesa-dri chromium python3-pyopencolorio valgrind libembree-dev
  libopenmpi-dev openmpi-bin"
node_is_new_enough || packages="$packages nodejs"
command -v npm >/dev/null 2>&1 || packages="$packages npm"
! grep -qi mpfr $(find tests -name CMakeLists.txt) || packages="$packages libmpfr-dev"
# shellcheck disable=SC2086 # the list is split into words on purpose
sh samples/install-packages.sh $packages
node_is_new_enough || { echo "run.sh: $(command -v node) is older than 18, the least that the tests run on" >&2; exit 1; }

sh tests/install-modules.sh
HEMIBAKE_PYTHON=$(sh tests/install-python.sh)
export HEMIBAKE_PYTHON

# ---- builds and tests ----------------------------------------------------------------------------------------------

passed=0 failed=0 skipped=0 all_results=

# An attribute of the suite in CTest's JUnit file.
count() {
  sed -n 's/^[[:space:]]*'"$1"'="\([0-9]*\)".*/\1/p' "$2" | head -n 1
}

# run_tests PRESET [ctest argument ...]: builds, runs, adds to the three sums.
run_tests() {
  preset=$1
  shift
  cmake --preset "$preset" -DHEMIBAKE_TESTS=ON -DPython3_EXECUTABLE="$HEMIBAKE_PYTHON"
  cmake --build --preset "$preset" -- -j2
  results=$root/build/$preset/tests.xml
  rm -f "$results"
  # Whole outputs, since reasons for skipping are taken from them.
  ctest --preset "$preset" -j2 --no-tests=error --output-junit "$results" --test-output-size-passed 1000000 \
    --test-output-size-failed 1000000 "$@" || true
  all_results="$all_results build/$preset/tests.xml"
  failures=$(count failures "$results")
  skips=$(($(count skipped "$results") + $(count disabled "$results")))
  passed=$((passed + $(count tests "$results") - failures - skips))
  failed=$((failed + failures))
  skipped=$((skipped + skips))
}

run_tests release

# A finding of a sanitizer must not look like exit status 1, which means bad input.
export ASAN_OPTIONS=exitcode=99:detect_stack_use_after_return=1
export UBSAN_OPTIONS=exitcode=99:print_stacktrace=1
export LSAN_OPTIONS="exitcode=99:print_suppressions=0:suppressions='$root/tests/lsan.supp'"
# shellcheck disable=SC2086 # two words, or none
run_tests asan $exclude

[ "$skipped" -eq 0 ] || skips=", $skipped skipped"
[ "$skipped" -ne 0 ] || skips=
silent=0
# shellcheck disable=SC2086
"$HEMIBAKE_PYTHON" -B tests/skips.py $all_results || silent=1
echo "$passed passed, $failed failed$skips"
[ "$failed" -eq 0 ] && [ "$silent" -eq 0 ]
