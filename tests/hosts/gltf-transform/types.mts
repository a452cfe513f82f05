// SPDX-License-Identifier: MIT
// Do the types say what the package takes? Compiled by tsc, never run.
import { Document } from '@gltf-transform/core';
import { bake, bakeScene, BAKE_DEFAULTS, version, type BakeOptions } from 'hemibake-gltf-transform';

const options: BakeOptions = { quality: 'high', exposure: 'auto', onProgress: (fraction) => fraction < 0.5 };
await new Document().transform(bake(), bake(options), bake({ ...BAKE_DEFAULTS, exposure: -1, colorFormat: 'f32' }));
const scene = { materials: [{ reflectance: [1, 1, 1] as [number, number, number], emission: [0, 0, 0] as [number, number, number] }], meshes: [] };
const baked = await bakeScene(scene, { signal: AbortSignal.timeout(1) });
const first: Float32Array = baked.meshes[0].radiance;
await bakeScene({ ...scene, lights: [{ kind: 'point', intensity: [1, 1, 1] }], sky: { radiance: [1, 1, 1] } });
bake({ sun: [150, 40, 8], environment: [1, 1, 1] });
console.log(version().length, first.length, baked.statistics.errorEstimate);

// @ts-expect-error: no such option
bake({ qualty: 'high' });
// @ts-expect-error: no such quality
bake({ quality: 'best' });
// @ts-expect-error: no such light
bakeScene({ ...scene, lights: [{ kind: 'lamp', intensity: [1, 1, 1] }] });
// @ts-expect-error: numbers are no arrays
bakeScene({ materials: [], meshes: [{ positions: [0], indices: new Uint32Array(), material: 0 }] });
