#!/bin/sh
# SPDX-License-Identifier: MIT
# Does everything hold that takes longer than CI may? Each step within its time; what it said lies in build/nightly/STEP.log.
#
#     sh tests/nightly.sh [STEP ...]       all, or those that are named
#     sh tests/nightly.sh --list           their names and times
#
# One table: step, seconds, status, its last line. Ends with how many fell short, which is the exit status. A step that says it was skipped
# (status 77) did not fall short, and is counted by itself.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."

# name, minutes, command
steps() {
  cat <<'EOF'
tests 120 sh tests/run.sh --all
fuzz 120 sh tests/fuzz/run.sh ${HEMIBAKE_FUZZ_SECONDS:-600}
usd-fuzz 30 $HEMIBAKE_PYTHON -B tests/fuzz/usd_stages.py --count 500
real-assets 60 $HEMIBAKE_PYTHON -B tests/fuzz/real_assets.py --count 10000
hard-cases 180 $HEMIBAKE_PYTHON -B tests/accuracy/hard_cases/run.py --quality high
field 120 $HEMIBAKE_PYTHON -B tests/field/run.py --quality all
corpus 120 sh tests/corpus/run.sh
mutations 90 sh tests/mutations.sh
kills 90 sh tests/faults/run.sh
tsan 90 sh tests/tsan.sh
memcheck 60 sh tests/memcheck.sh
reproducible 45 sh tests/reproducible.sh
sbom 10 sh tests/sbom.sh
analyzers 90 sh tests/analyze.sh
quality 60 sh tests/bench/quality.sh
scaling 60 sh tests/bench/scaling.sh
host-cost 20 $HEMIBAKE_PYTHON -B tests/bench/hosts.py build/release 5 --check
speed-error 90 sh tests/bench/speed_error.sh
EOF
}

if [ "${1:-}" = --list ]; then
  steps | while read -r name minutes command; do printf '%-14s %4s min  %s\n' "$name" "$minutes" "$command"; done
  exit 0
fi
for name in "$@"; do
  steps | grep -q "^$name " || { echo "nightly.sh: no step $name; there are: $(steps | cut -d' ' -f1 | tr '\n' ' ')" >&2; exit 2; }
done

HEMIBAKE_PYTHON=${HEMIBAKE_PYTHON:-$(sh tests/install-python.sh)}
export HEMIBAKE_PYTHON
logs=$PWD/build/nightly
mkdir -p "$logs"
table=$logs/table.txt
: >"$table"

# One step; its row goes into the table.
run_step() {
  name=$1 minutes=$2 command=$3 status=0 begin=$(date +%s)
  timeout --kill-after=30 "${minutes}m" sh -c "$command" >"$logs/$name.log" 2>&1 </dev/null || status=$?
  said=$(grep -v '^[[:space:]]*$' "$logs/$name.log" | tail -n 1 | cut -c 1-90)
  case $status in
    0) word=right ;;
    77) word=skipped ;;
    124 | 137) word="SHORT: not done in $minutes min" ;;
    *) word="SHORT ($status)" ;;
  esac
  printf '%-14s %7d s  %-16s %s\n' "$name" $(($(date +%s) - begin)) "$word" "$said" | tee -a "$table"
}

steps >"$logs/steps.txt"
while read -r name minutes command; do
  wanted=yes
  if [ $# -gt 0 ]; then
    wanted=
    for one in "$@"; do [ "$one" != "$name" ] || wanted=yes; done
  fi
  [ -z "$wanted" ] || run_step "$name" "$minutes" "$command"
done <"$logs/steps.txt"

fell=$(grep -c ' SHORT' "$table") || true
echo "$(wc -l <"$table") steps, $(grep -c ' s  skipped' "$table" || true) skipped, $fell fell short"
exit "$fell"
