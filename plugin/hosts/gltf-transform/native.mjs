// SPDX-License-Identifier: MIT
// How does JavaScript call the addon? bakeScene() bakes arrays on a thread of its own and returns a promise.

import { createRequire } from 'node:module';

const PATH = process.env.HEMIBAKE_NODE ?? new URL('./hemibake.node', import.meta.url).pathname;

const METHODS = ['hybrid', 'analytic', 'pr', 'fm'];
const LIGHTS = ['point', 'spot', 'directional'];
const QUALITIES = ['draft', 'medium', 'high', 'reference'];

let addon;

function load() {
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

function choice(name, words, value) {
	const at = words.indexOf(value);
	if (at < 0) throw new TypeError(`hemibake: ${name} '${value}' is none of ${words.join(', ')}`);
	return at;
}

/** Enums with a default count from 1; 0 is the default. */
function optional(name, words, value) {
	return value === undefined ? undefined : choice(name, words, value) + 1;
}

/** The scene with its lights' kinds as numbers. */
function numbered(scene) {
	if (!Array.isArray(scene?.lights)) return scene;
	return { ...scene, lights: scene.lights.map((light) => ({ ...light, kind: choice('kind', LIGHTS, light?.kind) })) };
}

/**
 * Bakes a scene of arrays. Units are metres and radiance in W/m2/sr; colours are linear Rec.709. The arrays are copied before
 * this returns; what the promise holds looks into the solution.
 */
export async function bakeScene(scene, options = {}) {
	const { onProgress, signal, quality, method, exposure, ...rest } = options;
	signal?.throwIfAborted();
	let thrown;
	const settings = {
		...rest,
		quality: optional('quality', QUALITIES, quality),
		method: optional('method', METHODS, method),
		exposure: exposure === 'auto' ? undefined : exposure,
	};
	const progress = onProgress && ((fraction, stage) => {
		try {
			if (onProgress(fraction, stage) !== false) return;
		} catch (error) {
			thrown ??= error;
		}
		cancel();
	});
	const { promise, cancel, abandon } = load().start(numbered(scene), settings, progress);
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
