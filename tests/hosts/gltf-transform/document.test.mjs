// SPDX-License-Identifier: MIT
// Does a Document get the light that the command gives, and keep everything else?

import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, test } from 'node:test';
import { dequantize, draco, quantize } from '@gltf-transform/functions';
import { bake, BAKE_DEFAULTS } from 'hemibake-gltf-transform';
import { assertHeldBriefly, furnished, instanced, large, lit, makeIO, meanRadiance, switching } from './rooms.mjs';

const { HEMIBAKE, HEMIBAKE_SAMPLES } = process.env;
const ROOM = join(HEMIBAKE_SAMPLES, 'pillar-room.glb');
const DRAFT = { quality: 'draft' };

const folder = mkdtempSync(join(tmpdir(), 'hemibake node '));
after(() => rmSync(folder, { recursive: true }));
const io = await makeIO();

function command(...args) {
	const ran = spawnSync(HEMIBAKE, ['bake', '--quiet', ...args], { encoding: 'utf8' });
	assert.equal(ran.status, 0, ran.stderr);
}

/** Node by name: its primitives. */
function primitivesOf(document) {
	const nodes = document.getRoot().listNodes().filter((node) => node.getMesh());
	return Object.fromEntries(nodes.map((node) => [node.getName(), node.getMesh().listPrimitives()]));
}

function warnings(document) {
	const heard = [];
	const logger = document.getLogger();
	document.setLogger({ ...logger, debug() {}, info() {}, warn: (text) => heard.push(text), error: (text) => heard.push(text) });
	return heard;
}

// off: by how many codes colours may differ, of 65,535.
async function assertLikeTheCommand(asset, options, flags = [], off = 0) {
	const out = join(folder, 'command.glb');
	command(asset, '-o', out, '--quality', 'draft', '--no-draco', ...flags);
	const theirs = primitivesOf(await io.read(out));
	const document = await io.read(asset);
	await document.transform(bake({ ...DRAFT, ...options }));
	const ours = primitivesOf(document);
	assert.deepEqual(Object.keys(ours), Object.keys(theirs));
	for (const [name, primitives] of Object.entries(ours)) {
		assert.equal(primitives.length, theirs[name].length);
		primitives.forEach((primitive, i) => {
			for (const semantic of ['POSITION', 'COLOR_0']) {
				const a = primitive.getAttribute(semantic).getArray(), b = theirs[name][i].getAttribute(semantic).getArray();
				const isNear = off > 0 && semantic === 'COLOR_0' && a.length === b.length && a.every((code, k) => Math.abs(code - b[k]) <= off);
				if (!isNear) assert.deepEqual(a, b, `${name} ${semantic}`);
			}
			assert.deepEqual([...primitive.getIndices().getArray()], [...theirs[name][i].getIndices().getArray()]);
		});
	}
	return document;
}

test('geometry and colours are those of the command', async () => assertLikeTheCommand(ROOM, {}));

test('half metals reflect half of what they do without, as in the command', async () => {
	const asset = join(folder, 'metal.glb');
	const room = await io.read(ROOM);
	for (const material of room.getRoot().listMaterials()) material.setMetallicFactor(0.5);
	await io.write(asset, room);
	await assertLikeTheCommand(asset, { mergeError: 0 }, ['--merge-error', '0']);
});

test('lights of the asset, a sun and a sky are those of the command', async () => {
	const asset = join(folder, 'lit.glb');
	await io.write(asset, lit());
	// Lights that differ by a rounding may merge other triangles, so none are, and what lies between two codes may get either.
	const all = (options, ...flags) => assertLikeTheCommand(asset, { mergeError: 0, ...options }, ['--merge-error', '0', ...flags], 1);
	const document = await all({});
	assert.equal(document.getRoot().listNodes().filter((node) => node.getExtension('KHR_lights_punctual')).length, 3);
	await all({ sun: [150, 40, 8, 2], environment: [0.5, 0.7, 1] }, '--sun', '150,40,8,2', '--environment', '0.5,0.7,1');
	// Other primaries move the lights' colours too.
	await all({ workingSpace: 'ACEScg' }, '--working-space', 'ACEScg');
});

test('the event loop is held briefly', async () => {
	const asset = async () => io.read(ROOM);
	const rooms = await Promise.all([1, 2, 3].map(asset));
	await assertHeldBriefly('the room', rooms.map((document) => () => document.transform(bake({ ...DRAFT, threads: 1, colorFormat: 'f32' }))));
	// 100,000 triangles in one mesh, on their way in: the bake is cancelled when it has begun.
	const cancelled = (document) => () => assert.rejects(document.transform(bake({ onProgress: () => false })), { code: 'HEMI_CANCELLED' });
	await assertHeldBriefly('a large mesh', [1, 2, 3].map(() => cancelled(large(224))));
});

test('everything else is kept', async () => {
	const document = furnished();
	const heard = warnings(document);
	await document.transform(bake(DRAFT));
	const root = document.getRoot();
	const by = (list, name) => list.find((each) => each.getName() === name);
	const { left, right, glass, moving } = primitivesOf(document);

	assert.equal(by(root.listNodes(), 'left').getExtras().id, 7);
	assert.ok(by(root.listNodes(), 'camera').getCamera());
	assert.equal(root.listAnimations()[0].listChannels().length, 1);
	assert.deepEqual(heard, ["bake: a primitive of 'glass' stays as it is, in the way of light: light passes through it"]);
	assert.equal(glass[0].getMaterial().getAlphaMode(), 'BLEND');
	assert.equal(glass[0].getAttribute('COLOR_0'), null);
	assert.ok(moving[0].getMaterial().getExtension('KHR_materials_unlit'), 'what moves is baked where it rests');

	const [a, b] = [left[0], right[0]];
	assert.notEqual(by(root.listNodes(), 'left').getMesh(), by(root.listNodes(), 'right').getMesh());
	assert.notDeepEqual(a.getAttribute('COLOR_0').getArray(), b.getAttribute('COLOR_0').getArray());
	assert.equal(a.getMaterial(), b.getMaterial());
	assert.ok(a.getMaterial().getExtension('KHR_materials_unlit'));
	assert.deepEqual(a.getMaterial().getExtras(), { keep: 'me' });
	assert.equal(a.getMaterial().getNormalTexture(), null);
	assert.equal(a.getMaterial().getBaseColorTexture().getName(), 'wood');
	assert.deepEqual(a.listSemantics().toSorted(), ['COLOR_0', 'POSITION', 'TEXCOORD_0']);
	const positions = a.getAttribute('POSITION').getArray();
	const texcoords = a.getAttribute('TEXCOORD_0').getArray();
	for (let v = 0; v < positions.length / 3; v++) {
		// The square's texture coordinates are its x and z.
		assert.ok(Math.abs(texcoords[2 * v] - positions[3 * v]) < 1e-6);
		assert.ok(Math.abs(texcoords[2 * v + 1] - positions[3 * v + 2]) < 1e-6);
	}
	assert.equal(root.listMaterials().some((material) => material.getName() === 'lamp' && !material.getExtension('KHR_materials_unlit')), false);
	const written = await io.readBinary(await io.writeBinary(document));
	assert.deepEqual(Object.keys(primitivesOf(written)), Object.keys(primitivesOf(document)));
});

test('what moves, hides, blends or is unlit does to the rest what it does in the command', async () => {
	const asset = join(folder, 'switching.glb');
	await io.write(asset, switching());
	const linear = join(folder, 'switching.linear.glb');
	command(asset, '-o', linear, '--quality', 'draft', '--no-draco', '--scene-linear', '--element-size', '0.1');
	const theirs = primitivesOf(await io.read(linear));
	const document = await io.read(asset);
	const heard = warnings(document);
	await document.transform(bake({ ...DRAFT, sceneLinear: true, elementSize: 0.1 }));
	const ours = primitivesOf(document);
	for (const name of ['floor', 'moving']) {
		const [a, b] = [ours, theirs].map((all) => meanRadiance(all[name][0]));
		for (let c = 0; c < 3; c++) assert.ok(Math.abs(a[c] / b[c] - 1) < 0.01, `${name}: ${a}, in the command ${b}`);
	}
	assert.equal(ours.hidden[0].getAttribute('COLOR_0'), null);
	const said = [['pane', 'light passes'], ['veil', 'light passes'], ['card', 'it is unlit'], ['floor', 'loses its variants']];
	for (const [name, why] of said) assert.ok(heard.some((line) => line.includes(`'${name}'`) && line.includes(why)), `${name}: ${heard}`);
	assert.equal(heard.length, said.length, heard.join('\n'));
});

test('GPU instances become nodes with light of their own', async () => {
	const document = instanced();
	await document.transform(bake(DRAFT));
	assert.equal(document.getRoot().listNodes().filter((node) => node.getMesh()).length, 4);
	for (const node of document.getRoot().listNodes()) assert.equal(node.getExtension('EXT_mesh_gpu_instancing'), null);
});

test('quantized and compressed documents give the light of plain ones', async () => {
	const plain = await io.read(ROOM);
	const document = await io.read(ROOM);
	await document.transform(quantize({ quantizePosition: 16 }), draco());
	const again = await io.readBinary(await io.writeBinary(document));
	await plain.transform(bake({ ...DRAFT, sceneLinear: true }));
	await again.transform(bake({ ...DRAFT, sceneLinear: true }));
	// By area of each surface: how many vertices show it is another matter.
	const mean = (d) => {
		const all = Object.values(primitivesOf(d)).flat().flatMap(meanRadiance);
		return all.reduce((sum, x) => sum + x, 0) / all.length;
	};
	// Positions moved by 2^-14 of the room at most; a percent is far more than that can change.
	assert.ok(Math.abs(mean(again) / mean(plain) - 1) < 0.01, `${mean(again)} ${mean(plain)}`);
});

test('where the error lies comes as an attribute', async () => {
	const document = furnished();
	await document.transform(bake({ ...DRAFT, vertexErrors: true }));
	const errors = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives()).flatMap((primitive) => [...(primitive.getAttribute('_ERROR')?.getArray() ?? [])]);
	assert.ok(errors.every((one) => one >= 0) && Math.max(...errors) > 0 && Math.max(...errors) < 1, `${Math.max(...errors)}`);
});

test('scene-linear radiance comes whole, colours as floats where they are wanted', async () => {
	const document = furnished();
	await document.transform(bake({ ...DRAFT, sceneLinear: true, colorFormat: 'f32' }));
	const [lamp] = primitivesOf(document).lamp;
	assert.deepEqual([...lamp.getAttribute('_RADIOSITY').getArray().slice(0, 3)], [4, 4, 4]);
	assert.deepEqual(lamp.getAttribute('COLOR_0').getElement(0, []), [1, 1, 1]);
	assert.equal(lamp.getAttribute('COLOR_0').getType(), 'VEC3');
});

test('a document without anything to bake is told', async () => {
	const document = furnished();
	for (const name of ['left', 'right', 'lamp', 'moving']) {
		document.getRoot().listNodes().find((node) => node.getName() === name).dispose();
	}
	await assert.rejects(document.transform(bake()), /no triangles that can be baked/);
	await assert.rejects(document.transform(bake({ qualty: 'high' })), /'qualty' is no option; there are quality, method/);
});

test('the defaults are what the options say', () => {
	assert.deepEqual(BAKE_DEFAULTS, { colorFormat: 'u16norm' }); // all others are the library's
	assert.equal(bake().name, 'bake');
});

// ---- the command of glTF-Transform ----------------------------------------------------------------------------------------

const require = createRequire(import.meta.url);
const CLI = join(dirname(require.resolve('@gltf-transform/core')), '../../../.bin/gltf-transform');
const CONFIG = join(dirname(require.resolve('hemibake-gltf-transform')), 'gltf-transform.config.mjs');

function gltfTransform(...args) {
	return spawnSync(process.execPath, [CLI, ...args, '--config', CONFIG], { encoding: 'utf8', timeout: 120000 });
}

test('gltf-transform bake bakes', async () => {
	const out = join(folder, 'cli.glb');
	const ran = gltfTransform('bake', ROOM, out, '--quality', 'draft', '--exposure', '-1', '--element-size', '0.2');
	assert.equal(ran.status, 0, ran.stdout + ran.stderr);
	const document = await io.read(ROOM);
	await document.transform(bake({ quality: 'draft', exposure: -1, elementSize: 0.2 }));
	const [a, b] = [primitivesOf(await io.read(out)), primitivesOf(document)];
	for (const name of Object.keys(a)) {
		assert.deepEqual(a[name][0].getAttribute('COLOR_0').getArray(), b[name][0].getAttribute('COLOR_0').getArray());
	}
});

test('gltf-transform bake tells what is wrong', () => {
	for (const [flag, value, word] of [['--quality', 'best', 'quality'], ['--qualty', 'high', 'qualty'], ['--element-size', 'x', "'x' is not what it takes"]]) {
		const ran = gltfTransform('bake', ROOM, join(folder, 'no.glb'), flag, value);
		assert.notEqual(ran.status, 0);
		assert.match(ran.stdout + ran.stderr, new RegExp(word));
	}
});

test('dequantize before makes no difference', async () => {
	const [a, b] = [await io.read(ROOM), await io.read(ROOM)];
	await a.transform(bake(DRAFT));
	await b.transform(dequantize(), bake(DRAFT));
	assert.deepEqual(primitivesOf(a).floor[0].getAttribute('COLOR_0').getArray(), primitivesOf(b).floor[0].getAttribute('COLOR_0').getArray());
});
