#!/bin/sh
# SPDX-License-Identifier: MIT
# Does the npm package work? Puts it beside glTF-Transform, checks its types, and runs the tests with node's runner.
#
#     sh tests/hosts/gltf-transform/run.sh BUILD_FOLDER [test file ...]
#
# glTF-Transform is in build/tests/gltf-transform, where tests/install-modules.sh puts it. Exit status 77: it is not there, or
# node is older than 20.
set -eu

build=$(cd -- "$1" && pwd -P)
shift
CDPATH='' cd -- "$(dirname -- "$0")"
root=$(cd ../../.. && pwd -P)
place=$root/build/tests/gltf-transform
modules=$place/node_modules

[ -d "$modules" ] || { echo "run.sh: skipped: no $modules; run 'sh tests/install-modules.sh'" >&2; exit 77; }
[ -d "$build/node/hemibake-gltf-transform" ] || { echo "run.sh: skipped: the addon was not built; there is no node_api.h" >&2; exit 77; }
[ "$(node -p 'process.versions.node.split(".")[0]')" -ge 20 ] || { echo "run.sh: skipped: glTF-Transform needs node 20" >&2; exit 77; }

# node finds packages beside a file, whatever it links to; so tests and package are copied, the package as npm would.
cp ./*.mjs ./*.mts "$place"
packed=$(cd "$build/node/hemibake-gltf-transform" && npm pack --silent --pack-destination "$place")
rm -rf "$modules/hemibake-gltf-transform"
mkdir "$modules/hemibake-gltf-transform"
tar -xzf "$place/$packed" -C "$modules/hemibake-gltf-transform" --strip-components=1

cd "$place"
node node_modules/typescript/bin/tsc --noEmit --strict --target es2022 --module nodenext --skipLibCheck --lib es2023,dom \
  types.mts
export HEMIBAKE="$build/bin/hemibake" HEMIBAKE_SAMPLES="$root/samples"
[ $# -gt 0 ] || set -- scene.test.mjs document.test.mjs
exec node --test --test-concurrency=1 --test-reporter=spec "$@"
