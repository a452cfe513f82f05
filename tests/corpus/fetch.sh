#!/bin/sh
# SPDX-License-Identifier: MIT
# Where do the files of the corpus come from? Fetches the packages of packages.txt by name into build/corpus/ and unpacks
# them there; what is already there is not fetched again. Exit status 77: something could not be fetched.
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/../.."
list=$(pwd -P)/tests/corpus/packages.txt
mkdir -p build/corpus/packages
cd build/corpus/packages

# Debian's packages hold their files in a tree, some of them packed by dpkg once more.
fetch_debian() {
  (cd "$2" && apt-get -q download "$1" >/dev/null 2>&1 && dpkg -x "$1"_*.deb . && rm "$1"_*.deb)
}

fetch_npm() {
  (cd "$2" && tarball=$(npm pack --silent "$1@$3" 2>/dev/null | tail -n 1) && tar -xzf "$tarball" && rm "$tarball")
}

failed=0
while read -r kind name version; do
  case $kind in '' | \#*) continue ;; esac
  folder=$(printf %s "$name" | tr '@/' '__')
  [ -d "$folder" ] && continue
  rm -rf "$folder.part"
  mkdir "$folder.part"
  if "fetch_$kind" "$name" "$folder.part" "$version"; then
    mv "$folder.part" "$folder"
  else
    echo "fetch.sh: $name could not be fetched" >&2
    rm -rf "$folder.part"
    failed=77
  fi
done <"$list"
exit "$failed"
