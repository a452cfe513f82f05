#!/bin/sh
# SPDX-License-Identifier: MIT
# Do two builds in two places give the same bits? Builds what is committed twice, in folders of different names and depths and at different
# times, without a compiler cache, and compares the command, the library and the wheel.
#
#     sh tests/reproducible.sh
#
# One line a file; the exit status is the number of files that differ.
set -eu
CDPATH='' cd -- "$(dirname -- "$0")/.."
commit=$(git rev-parse HEAD)
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH CCACHE_DISABLE=1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# build PLACE: the tree of the commit there, built.
build() {
  mkdir -p "$folder/$1"
  git archive "$commit" | tar -x -C "$folder/$1"
  (
    cd "$folder/$1"
    cmake --preset release -DHEMIBAKE_TESTS=OFF >/dev/null
    cmake --build --preset release --target hemibake_shared hemibake_cli -- -j2 >/dev/null
    HEMIBAKE_BUILD=$PWD/build/release sh plugin/hosts/python/build-wheel.sh "$PWD/wheels" >/dev/null
  )
}

build a
build a/longer/name-of-another-place
fell=0
for file in build/release/bin/hemibake "$(cd "$folder/a" && find build/release -name 'libhemibake.so.*.*.*' | head -n 1)" \
  "wheels/$(cd "$folder/a/wheels" && ls hemibake-*.whl)"; do
  if cmp -s "$folder/a/$file" "$folder/a/longer/name-of-another-place/$file"; then
    echo "same    $(sha256sum <"$folder/a/$file" | cut -c1-16)  $file"
  else
    echo "DIFFERS $file"
    fell=$((fell + 1))
  fi
done
exit "$fell"
