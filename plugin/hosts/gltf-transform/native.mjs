// SPDX-License-Identifier: MIT
// How does JavaScript call the addon? bakeScene() bakes arrays on a thread of its own and returns a promise.

import { createRequire } from 'node:module';
import { optionTexts } from './options.mjs';

const PATH = process.env.HEMIBAKE_NODE ?? new URL('./hemibake.node', import.meta.url).pathname;

const LIGHTS = ['point', 'spot', 'directional'];

let addon;

/** The addon. */
export function load() {
	try {
		addon ??= createRequire(import.meta.url)(decodeURIComponent(PATH));
	} catch (cause) {
		throw new Error(`hemibake: the addon cannot be loaded: ${cause.message}`, { cause });
	}
	return addon;
}

/** The version of the library behind the addon. */
export function version() {
	return load().version;
}

function kindOf(light) {
	const at = LIGHTS.indexOf(light?.kind);
	if (at < 0) throw new TypeError(`hemibake: kind '${light?.kind}' is none of ${LIGHTS.join(', ')}`);
	return at;
}

/** The scene with its lights' kinds as numbers. */
function numbered(scene) {
	if (!Array.isArray(scene?.lights)) return scene;
	return { ...scene, lights: scene.lights.map((light) => ({ ...light, kind: kindOf(light) })) };
}

/**
 * Bakes a scene of arrays. Units are metres and radiance in W/m2/sr; colours are linear Rec.709. The arrays are copied before
 * this returns; what the promise holds looks into the solution.
 */
export async function bakeScene(scene, options = {}) {
	const { onProgress, signal, ...settings } = options;
	signal?.throwIfAborted();
	let thrown;
	const texts = optionTexts(settings);
	const progress = onProgress && ((fraction, stage) => {
		try {
			if (onProgress(fraction, stage) !== false) return;
		} catch (error) {
			thrown ??= error;
		}
		cancel();
	});
	const { promise, cancel, abandon } = load().start(numbered(scene), texts, progress);
	process.once('exit', abandon);
	signal?.addEventListener('abort', cancel, { once: true });
	try {
		return await promise;
	} catch (error) {
		if (error.code === 'HEMI_CANCELLED') {
			if (thrown) throw thrown;
			signal?.throwIfAborted();
		}
		error.message = `hemibake: ${error.message}`;
		throw error;
	} finally {
		process.off('exit', abandon);
		signal?.removeEventListener('abort', cancel);
	}
}
