#!/bin/sh
# SPDX-License-Identifier: MIT
# Which npm packages do the tests use? Those of each package.json here, in the versions of the lock beside it, put into build/tests.
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/.."
root=$(pwd -P)

# install FOLDER PLACE: the packages of FOLDER/package.json into PLACE/node_modules, if they are not there.
install() {
  cmp -s "$1/package-lock.json" "$2/package-lock.json" && [ -d "$2/node_modules" ] && return
  mkdir -p "$2"
  cp "$1/package.json" "$1/package-lock.json" "$2/"
  cd "$2"
  npm ci --no-audit --no-fund || { rm package-lock.json; exit 1; }
  cd "$root"
}

install tests build/tests
install tests/hosts/gltf-transform build/tests/gltf-transform
