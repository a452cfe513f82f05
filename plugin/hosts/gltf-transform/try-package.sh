#!/bin/sh
# SPDX-License-Identifier: MIT
# Does the npm package work where nothing of this tree is? Packs it, with the addon in it, installs that file and glTF-Transform into a
# new folder, and bakes a sample there.
#
#     sh plugin/hosts/gltf-transform/try-package.sh [FOLDER]      keeps the package, hemibake-gltf-transform-*.tgz, in FOLDER
#
# $HEMIBAKE_BUILD names a build of the tree to take; without it build/release is built. glTF-Transform and Draco come from where npm takes
# packages, in any version that the package asks for. Not run by CTest.
set -eu

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
root=$(CDPATH='' cd -- "$here/../../.." && pwd -P)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ -z "${HEMIBAKE_BUILD:-}" ]; then
  (cd "$root" && cmake --preset release && cmake --build --preset release --target hemibake_node hemibake_node_work) >&2
  HEMIBAKE_BUILD=$root/build/release
fi
package=$HEMIBAKE_BUILD/node/hemibake-gltf-transform
[ -f "$package/hemibake.node" ] || { echo "try-package.sh: there is no $package/hemibake.node: node_api.h was not found" >&2; exit 1; }
mkdir -p "${1:-$work/packed}"
out=$(CDPATH='' cd -- "${1:-$work/packed}" && pwd -P)
packed=$out/$(cd "$package" && npm pack --silent --pack-destination "$out")
echo "$packed, $(wc -c <"$packed") bytes"

mkdir "$work/clean"
cd "$work/clean"
npm init --yes >/dev/null
npm install --silent --no-audit --no-fund "$packed" draco3dgltf
cp "$root/samples/pillar-room.glb" in.glb
cat >try.mjs <<'END'
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { draco } from '@gltf-transform/functions';
import draco3d from 'draco3dgltf';
import { bake, version } from 'hemibake-gltf-transform';

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
	'draco3d.decoder': await draco3d.createDecoderModule(), 'draco3d.encoder': await draco3d.createEncoderModule(),
});
const document = await io.read('in.glb');
await document.transform(bake({ quality: 'draft' }), draco({ quantizeColor: 12 }));
await io.write('out.glb', document);
const baked = await io.read('out.glb');
const primitives = baked.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives());
const shades = primitives.flatMap((one) => [...(one.getAttribute('COLOR_0')?.getArray() ?? [])]);
if (!primitives.every((one) => one.getAttribute('COLOR_0')) || new Set(shades).size < 100) throw new Error('there is no light in the vertices');
const vertices = primitives.reduce((sum, one) => sum + one.getAttribute('POSITION').getCount(), 0);
console.log(`tried: hemibake ${version()}, node ${process.version}: ${primitives.length} primitives, ${vertices} lit vertices, in a clean folder`);
END
env -u HEMIBAKE_NODE node try.mjs
env -u HEMIBAKE_NODE node --input-type=module -e "
import config from 'hemibake-gltf-transform/gltf-transform.config.mjs';
if (typeof config.onProgramReady !== 'function') throw new Error('the command of glTF-Transform gets nothing');
"
