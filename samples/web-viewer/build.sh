#!/bin/sh
# SPDX-License-Identifier: MIT
# Bundles the viewer, with three.js and its Draco decoder, into a folder that any web server can serve.
#
#     sh samples/web-viewer/build.sh [FOLDER]      default: build/web-viewer
#
# The packages come from npm, in the versions of the lock, unless the tests have them here already.
set -eu

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
root=$(CDPATH='' cd -- "$here/../.." && pwd -P)
out=${1:-$root/build/web-viewer}
mkdir -p "$out"
out=$(CDPATH='' cd -- "$out" && pwd -P)

version() {
  node -p "require('$1/package.json').version" 2>/dev/null || true
}

command -v npm >/dev/null 2>&1 || {
  echo "build.sh: the viewer needs npm and node 18 or newer (Debian: apt install nodejs npm)" >&2
  exit 1
}
modules=$root/build/tests/node_modules
for package in three esbuild; do
  wanted=$(node -p "require('$here/package.json').dependencies['$package']")
  [ "$(version "$modules/$package")" = "$wanted" ] || modules=
  [ -n "$modules" ] || break
done
if [ -z "$modules" ]; then
  place=$root/build/web-viewer-packages
  mkdir -p "$place"
  cp "$here/package.json" "$here/package-lock.json" "$place/"
  (cd "$place" && npm ci --no-audit --no-fund --silent)
  modules=$place/node_modules
fi

NODE_PATH=$modules "$modules/.bin/esbuild" "$here/viewer.mjs" --bundle --minify --format=iife --target=es2020 --legal-comments=none \
  --log-level=warning --outfile="$out/viewer.js"
mkdir -p "$out/draco"
for file in draco_decoder.js draco_decoder.wasm draco_wasm_wrapper.js; do
  cp "$modules/three/examples/jsm/libs/draco/gltf/$file" "$out/draco/" 2>/dev/null || cp "$modules/three/examples/jsm/libs/draco/$file" "$out/draco/"
done
cp "$modules/three/LICENSE" "$out/three.LICENSE"
cp "$here/index.html" "$out/"
