// SPDX-License-Identifier: MIT
// How does a Document get its light? Made ready, handed to the library as a scene, and filled with what comes back.

import { assignDefaults, createTransform, uninstance } from '@gltf-transform/functions';
import { setImmediate } from 'node:timers/promises';
import { listBakeable, listLights, materialDesc, meshDesc, sunDesc, texcoordNames } from './document_scene.mjs';
import { disposeUnused, replaceGeometry, unlitMaterial } from './document_result.mjs';
import { bakeScene } from './native.mjs';
import { optionTexts } from './options.mjs';

const NAME = 'bake';

/** What the library has no default for: the rest follows from it. */
export const BAKE_DEFAULTS = {
	colorFormat: 'u16norm',
};

/**
 * Solves the radiosity of the scene and writes its light into vertex colours; materials become unlit.
 *
 * What moves is baked where it rests. Surfaces that cannot be baked (skinned, morphed, blended by a picture) pass through, with a
 * warning; unlit ones and glass stay as they are, in the way of light; and so does everything else: cameras, animations, extras, extensions. GPU instances become nodes and quantized geometry becomes floats, since
 * light differs from one instance to the next. The work is done on a thread of its own.
 *
 * Example:
 *
 * ```javascript
 * import { bake } from 'hemibake-gltf-transform';
 *
 * await document.transform(bake({ quality: 'high', exposure: 'auto' }));
 * ```
 *
 * @category Transforms
 */
export function bake(_options = BAKE_DEFAULTS) {
	const options = assignDefaults(BAKE_DEFAULTS, _options);
	return createTransform(NAME, async (document) => {
		const logger = document.getLogger();
		const { colorFormat, sun, environment, onProgress, signal, ...settings } = options;
		optionTexts({ ...settings, sun, environment }, true);
		await document.transform(uninstance());
		const targets = listBakeable(document, logger);
		if (targets.every((target) => target.stays)) throw new Error(`${NAME}: the scene has no triangles that can be baked`);
		const scene = await describe(targets);
		scene.lights = listLights(document);
		if (sun) scene.lights.push(sunDesc(sun));
		if (environment) scene.sky = { radiance: environment };
		const result = await bakeScene(scene, { ...settings, onProgress, signal });
		await fill(document, targets, scene, result, options);
		const { errorEstimate, elements, seconds, converged } = result.statistics;
		logger.info(`${NAME}: ${elements} elements, error about ${(100 * errorEstimate).toFixed(1)} %, ${seconds.toFixed(2)} s`);
		if (!converged) logger.warn(`${NAME}: stopped before it converged`);
		logger.debug(`${NAME}: Complete.`);
	});
}

async function describe(targets) {
	const materials = new Map();
	const scene = { materials: [], meshes: [] };
	for (const target of targets) {
		const material = target.primitive.getMaterial();
		if (!materials.has(material)) {
			materials.set(material, scene.materials.length);
			scene.materials.push(materialDesc(material));
		}
		scene.meshes.push(await meshDesc(target, materials.get(material)));
		await setImmediate(); // others have their turn between meshes
	}
	return scene;
}

async function fill(document, targets, scene, result, options) {
	const unlit = new Map();
	const old = new Set();
	for (let i = 0; i < targets.length; i++) {
		const { primitive, name, stays } = targets[i];
		if (stays) continue;
		if (primitive.getExtension('KHR_materials_variants'))
			document.getLogger().warn(`bake: a primitive of '${name}' loses its variants: the light is that of its own material`);
		for (const property of document.getGraph().listChildren(primitive)) old.add(property);
		if (!(await replaceGeometry(document, targets[i], scene.meshes[i], result.meshes[i], options))) continue;
		const textured = texcoordNames(primitive).length > 0;
		const source = primitive.getMaterial();
		const copies = unlit.get(source) ?? unlit.set(source, {}).get(source);
		copies[textured] ??= unlitMaterial(document, source, textured);
		primitive.setMaterial(copies[textured]);
		await setImmediate();
	}
	disposeUnused(document, old);
}
