// SPDX-License-Identifier: MIT
// Are scenes of arrays baked beside the event loop, and is what cannot be baked refused in JavaScript's own way?

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { copyFileSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { Worker } from 'node:worker_threads';
import { bakeScene, version } from 'hemibake-gltf-transform';
import { assertHeldBriefly, FLOOR, SQUARE, squares } from './rooms.mjs';

const DRAFT = { quality: 'draft' };
const ENDLESS = { elementSize: 0.01, patchSize: 0.02, unshot: 1e-9 };

test('the light is that of the closed form', async () => {
	const { meshes, statistics } = await bakeScene(squares(), { quality: 'medium' });
	const [floor] = meshes;
	let nearest = 0;
	const distance = (v) => Math.hypot(floor.positions[3 * v] - 0.5, floor.positions[3 * v + 2] - 0.5);
	for (let v = 0; v < floor.positions.length / 3; v++) if (distance(v) < distance(nearest)) nearest = v;
	// The centre sees 0.2395 of the lamp and reflects half; 1 %: the mesh is medium.
	assert.ok(Math.abs(floor.radiance[3 * nearest] / (0.5 * 0.2395) - 1) < 0.01, `${floor.radiance[3 * nearest]}`);
	assert.equal(statistics.converged, true);
	assert.equal(floor.colors.length, (4 * floor.positions.length) / 3);
	assert.match(version(), /^\d+\.\d+\.\d+$/);
});

test('a scene without light is lit by a sky of radiance 1', async () => {
	const scene = squares();
	scene.materials[1].emission = [0, 0, 0];
	const { meshes } = await bakeScene(scene, DRAFT);
	// The floor reflects half of what it sees, of which the dark square above hides a fifth and gives nothing back but
	// a few percent.
	for (const L of meshes[0].radiance) assert.ok(L > 0.3 && L < 0.5 * 1.001, `${L}`);
});

/** The radiance of the floor's vertex nearest to its middle. */
function middle({ meshes: [floor] }) {
	let nearest = 0;
	const distance = (v) => Math.hypot(floor.positions[3 * v] - 0.5, floor.positions[3 * v + 2] - 0.5);
	for (let v = 0; v < floor.positions.length / 3; v++) if (distance(v) < distance(nearest)) nearest = v;
	return [...floor.radiance.subarray(3 * nearest, 3 * nearest + 3)];
}

for (const [what, lit, expected] of [
	// E = I / r^2 leaves as rho E / pi.
	['a point light', { lights: [{ kind: 'point', intensity: [18, 9, 0], position: [0.5, 3, 0.5] }] }, [1 / Math.PI, 0.5 / Math.PI, 0]],
	['a spot', { lights: [{ kind: 'spot', intensity: [18, 9, 0], position: [0.5, 3, 0.5], direction: [0, -1, 0], outerCone: 0.4 }] }, [1 / Math.PI, 0.5 / Math.PI, 0]],
	['a sun', { lights: [{ kind: 'directional', intensity: [4, 2, 0], direction: [0, -1, Math.sqrt(3)], angularDiameter: 0.01 }] }, [1 / Math.PI, 0.5 / Math.PI, 0]],
	['a sky', { sky: { radiance: [1, 2, 3] } }, [0.5, 1, 1.5]],
	['a panorama', { sky: { radiance: [2, 2, 2], image: new Float32Array([0.5, 1, 1.5, 9, 9, 9]), width: 1, height: 2 } }, [0.5, 1, 1.5]],
]) {
	test(`${what} lights a floor`, async () => {
		const scene = squares();
		scene.meshes.pop();
		const found = middle(await bakeScene({ ...scene, ...lit }, DRAFT));
		// 2 %: the mesh is that of a draft, the sky three hundred directions.
		found.forEach((L, c) => assert.ok(Math.abs(L - expected[c]) <= 0.02 * expected[c] + 1e-6, `${found}`));
	});
}

test('results outlive collection, inputs may change', async () => {
	const scene = squares();
	const promise = bakeScene(scene, DRAFT);
	scene.meshes[0] = undefined;
	const { meshes } = await promise;
	const kept = Float32Array.from(meshes[0].radiance);
	for (let i = 0; i < 200; i++) new Float32Array(1e5).fill(i);
	assert.deepEqual(meshes[0].radiance, kept);
});

test('the event loop is held briefly', async () => {
	await assertHeldBriefly('arrays', Array(4).fill(() => bakeScene(squares(), { ...DRAFT, threads: 1 })));
});

test('four bakes at once are each what it is alone', async () => {
	const [alone] = (await bakeScene(squares(), DRAFT)).meshes;
	const all = await Promise.all([1, 2, 3, 4].map((threads) => bakeScene(squares(), { ...DRAFT, threads })));
	for (const { meshes } of all) assert.deepEqual(meshes[0].radiance, alone.radiance);
});

test('progress rises, false cancels, what a callback throws comes out', async () => {
	const seen = [];
	await bakeScene(squares(), { quality: 'medium', onProgress: (fraction) => void seen.push(fraction) });
	assert.deepEqual(seen, seen.toSorted((a, b) => a - b));
	assert.equal(seen.at(-1), 1);
	await assert.rejects(bakeScene(squares(), { ...ENDLESS, onProgress: () => false }), { code: 'HEMI_CANCELLED' });
	const mine = new RangeError('mine');
	await assert.rejects(bakeScene(squares(), { ...ENDLESS, onProgress: () => { throw mine; } }), mine);
});

test('a signal cancels, before and meanwhile', async () => {
	await assert.rejects(bakeScene(squares(), { signal: AbortSignal.abort() }), { name: 'AbortError' });
	await assert.rejects(bakeScene(squares(), { ...ENDLESS, signal: AbortSignal.timeout(50) }), { name: 'TimeoutError' });
});

for (const [what, change, expected] of [
	['no scene', () => undefined, TypeError],
	['no number', (s) => ((s.materials[0].reflectance = ['a', 1, 2]), s), /'reflectance' is not an array of numbers/],
	['two bands', (s) => ((s.materials[0].reflectance = [1, 2]), s), /'reflectance' is not an array of as many/],
	['NaN', (s) => ((s.meshes[0].positions = FLOOR.map(() => NaN)), s), /mesh 'floor': a position is not a finite number/],
	['an index', (s) => ((s.meshes[0].indices = SQUARE.map((i) => i + 1)), s), /mesh 'floor': an index is past its last vertex/],
	['a kind', (s) => ((s.meshes[0].positions = [...FLOOR]), s), /'positions' is not a Float32Array/],
	['a length', (s) => ((s.meshes[0].positions = FLOOR.slice(1)), s), /come in threes/],
	['a material', (s) => ((s.meshes[0].material = 9), s), /mesh 'floor': its material is not one of the scene's/],
	['a negative', (s) => ((s.meshes[0].material = -1), s), /'material' is not a whole number/],
	['a kind of light', (s) => ({ ...s, lights: [{ kind: 'lamp' }] }), /kind 'lamp' is none of point, spot, directional/],
	['no kind of light', (s) => ({ ...s, lights: [null] }), /kind 'undefined' is none of/],
	['a light', (s) => ({ ...s, lights: [{ kind: 'point', name: 'x', intensity: [1, -1, 1] }] }), /light 'x': its intensity/],
	['a list of lights', (s) => ({ ...s, lights: 7 }), /'lights' is not an array/],
	['a sky', (s) => ({ ...s, sky: { radiance: [NaN, 1, 1] } }), /sky: its radiance/],
	['an image', (s) => ({ ...s, sky: { image: new Float32Array(5), width: 1, height: 2 } }), /'image' does not have three numbers/],
	['a getter', (s) => Object.defineProperty(s, 'meshes', { get() { throw new Error('own'); } }), /own/],
]) {
	test(`${what} is told`, async () => assert.rejects(bakeScene(change(squares()), DRAFT), expected));
}

for (const [options, expected] of [
	[{ quality: 'best' }, /quality 'best' is none of draft, medium, high, reference/],
	[{ elementSize: -1 }, /--element-size: '-1' is not what it takes \(M, 1e-09 to 1e\+09\)/],
	[{ elementSize: NaN }, /--element-size: 'NaN' is not what it takes/],
	[{ hemicube: 64.5 }, /--hemicube: '64.5' is not what it takes/],
	[{ uniform: 1 }, /'uniform' is not true or false/],
	[{ qualty: 'high' }, /'qualty' is no option; there are quality, method/],
	[{ sun: [1, 2, 3] }, /'sun' is no option/], // it is bake's
	[{ report: 'x.json' }, /'report' is no option/], // it is the command's
	[{ elementSize: 'x' }, /'elementSize' is not a number/],
	[{ view: 'None such' }, /None such/],
	[{ ocio: '/nowhere.ocio' }, /nowhere/],
	[{ exposure: 1e9 }, /--exposure: '1000000000' is not what it takes \(EV\|auto, -64 to 64\)/],
]) {
	test(`${JSON.stringify(options)} is told`, async () => assert.rejects(bakeScene(squares(), options), expected));
}

function run(code, env = {}) {
	const prelude = "import { bakeScene } from 'hemibake-gltf-transform'; import { squares } from './rooms.mjs';";
	return spawnSync(process.execPath, ['--input-type=module', '-e', prelude + code], {
		cwd: import.meta.dirname, env: { ...process.env, ...env }, encoding: 'utf8', timeout: 60000,
	});
}

test('a missing addon is told', () => {
	const ran = run('bakeScene(squares()).catch((e) => console.log(e.message))', { HEMIBAKE_NODE: '/nowhere/hemibake.node' });
	assert.match(ran.stdout, /the addon cannot be loaded: .*\/nowhere\/hemibake\.node/);
});

test('a library that is not beside the addon is told', () => {
	const folder = mkdtempSync(join(tmpdir(), 'hemibake alone '));
	copyFileSync(createRequire(import.meta.url).resolve('hemibake-gltf-transform').replace('index.mjs', 'hemibake.node'), join(folder, 'hemibake.node'));
	const ran = run('bakeScene(squares()).catch((e) => console.log(e.message, e.code))', { HEMIBAKE_NODE: join(folder, 'hemibake.node') });
	rmSync(folder, { recursive: true });
	assert.match(ran.stdout, /the library cannot be loaded: .*hemibake_work\.so.* HEMI_ERROR_FILE/);
});

test('a process that exits in the middle of a bake exits', () => {
	const ran = run(`bakeScene(squares(), ${JSON.stringify(ENDLESS)}); setTimeout(() => process.exit(5), 100);`);
	assert.equal(ran.status, 5, ran.stderr);
});

test('a worker that is terminated in the middle of a bake takes nothing with it', async () => {
	const worker = new Worker(new URL('./endless.mjs', import.meta.url));
	await once(worker, 'message');
	await worker.terminate();
	assert.equal((await bakeScene(squares(), DRAFT)).statistics.converged, true);
});
