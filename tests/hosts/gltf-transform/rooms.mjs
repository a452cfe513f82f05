// SPDX-License-Identifier: MIT
// Which documents are baked in the tests, and how long does the event loop stand still meanwhile?

import assert from 'node:assert/strict';
import { openSync, readSync } from 'node:fs';
import { monitorEventLoopDelay, PerformanceObserver } from 'node:perf_hooks';
import { setTimeout } from 'node:timers/promises';
import { Document, NodeIO } from '@gltf-transform/core';
import {
	ALL_EXTENSIONS, EXTMeshGPUInstancing, KHRLightsPunctual, KHRMaterialsEmissiveStrength, KHRMaterialsTransmission, KHRMaterialsUnlit,
	KHRMaterialsVariants, KHRNodeVisibility,
} from '@gltf-transform/extensions';
import draco3d from 'draco3dgltf';

export const SQUARE = new Uint32Array([0, 1, 2, 0, 2, 3]);
export const FLOOR = new Float32Array([0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0]);
export const LAMP = new Float32Array([0, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1]);

export async function makeIO() {
	return new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
		'draco3d.decoder': await draco3d.createDecoderModule(),
		'draco3d.encoder': await draco3d.createEncoderModule(),
	});
}

const schedstat = openSync(`/proc/self/task/${process.pid}/schedstat`, 'r');
const text = Buffer.alloc(64);

/** Milliseconds that the thread of the event loop has worked, whoever else wanted the processor meanwhile. */
function worked() {
	return Number(text.toString('latin1', 0, readSync(schedstat, text, 0, 64, 0)).split(' ')[0]) / 1e6;
}

/**
 * How long did the event loop stand still at most, in milliseconds? blocked: its thread's work between two ticks of a timer of
 * 1 ms, without the engine's collections of garbage, which take up to 40 ms where a bake has the processors; late: how late such a
 * timer came, which an idle loop on a busy machine is too; took: the time of the whole work.
 */
export async function watch(work) {
	const delay = monitorEventLoopDelay({ resolution: 1 });
	const collections = [];
	const observer = new PerformanceObserver((list) => collections.push(...list.getEntries()));
	const ticks = [];
	let last = { at: performance.now(), work: worked() };
	const tick = () => {
		const now = { at: performance.now(), work: worked() };
		ticks.push({ from: last.at, to: now.at, work: now.work - last.work });
		last = now;
	};
	observer.observe({ entryTypes: ['gc'] });
	const timer = setInterval(tick, 1);
	delay.enable();
	const begin = performance.now();
	await work();
	const took = performance.now() - begin;
	tick();
	clearInterval(timer);
	delay.disable();
	await setTimeout(20); // what is observed is told later
	observer.disconnect();
	const collecting = ({ from, to }) =>
		collections.reduce((sum, c) => sum + Math.max(0, Math.min(to, c.startTime + c.duration) - Math.max(from, c.startTime)), 0);
	const blocked = ticks.map((t) => t.work - collecting(t));
	return { blocked: Math.max(0, ...blocked), late: delay.max / 1e6 - 1, took };
}

/** No work that is done beside the event loop may hold it for a larger share of its time: a bake inside of it would for all. */
const SHARE_AT_MOST = 0.15;

/**
 * Watches some tries and says for how long each held the event loop, and how late timers of an idle loop are here. Judged is the
 * middle one's share of the time that the try took: milliseconds are the machine's, and those of others who use it.
 */
export async function assertHeldBriefly(what, tries) {
	const idle = await watch(() => setTimeout(500));
	const seen = [];
	for (const each of tries) seen.push(await watch(each));
	const list = (key) => seen.map((s) => s[key].toFixed(1)).join(', ');
	console.log(
		`${what}: event loop held for ${list('blocked')} of ${list('took')} ms at most; timers late by ${list('late')} ms, idle by ${idle.late.toFixed(1)} ms`,
	);
	const shares = seen.map((s) => s.blocked / s.took).toSorted((a, b) => a - b);
	assert.ok(shares[Math.floor(shares.length / 2)] <= SHARE_AT_MOST, `shares ${shares}`);
}

/** A scene of arrays: a grey floor under a lamp. */
export function squares() {
	return {
		materials: [
			{ name: 'grey', reflectance: [0.5, 0.5, 0.5], emission: [0, 0, 0] },
			{ name: 'lamp', reflectance: [0, 0, 0], emission: [1, 1, 1] },
		],
		meshes: [
			{ name: 'floor', positions: FLOOR, indices: SQUARE, material: 0 },
			{ name: 'lamp', positions: LAMP, indices: SQUARE, material: 1 },
		],
	};
}

function addSquare(document, name, positions, material) {
	const buffer = document.getRoot().listBuffers()[0] ?? document.createBuffer();
	const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
	const primitive = document.createPrimitive().setMaterial(material).setIndices(accessor('SCALAR', Uint16Array.from(SQUARE)));
	primitive.setAttribute('POSITION', accessor('VEC3', positions));
	primitive.setAttribute('TEXCOORD_0', accessor('VEC2', new Float32Array([0, 0, 0, 1, 1, 1, 1, 0])));
	return document.createMesh(name).addPrimitive(primitive);
}

/** A document with all that must survive: two nodes of one mesh, a moving node, blended glass, a camera, extras, a texture. */
export function furnished() {
	const document = new Document();
	const strength = document.createExtension(KHRMaterialsEmissiveStrength).createEmissiveStrength().setEmissiveStrength(4);
	const lit = document.createMaterial('lamp').setEmissiveFactor([1, 1, 1]).setBaseColorFactor([0, 0, 0, 1]);
	lit.setExtension('KHR_materials_emissive_strength', strength);
	const texture = document.createTexture('wood').setMimeType('image/png').setImage(new Uint8Array([137, 80, 78, 71]));
	const normal = document.createTexture('bumps').setMimeType('image/png').setImage(new Uint8Array([137, 80, 78, 72]));
	const wood = document.createMaterial('wood').setMetallicFactor(0).setBaseColorTexture(texture).setNormalTexture(normal);
	wood.setExtras({ keep: 'me' });
	const glass = document.createMaterial('glass').setAlphaMode('BLEND').setBaseColorFactor([1, 1, 1, 0.5]);
	const floor = addSquare(document, 'floor', FLOOR, wood);
	const nodes = {
		left: document.createNode('left').setMesh(floor),
		right: document.createNode('right').setMesh(floor).setTranslation([1, 0, 0]),
		lamp: document.createNode('lamp').setMesh(addSquare(document, 'lamp', LAMP, lit)),
		glass: document.createNode('glass').setMesh(addSquare(document, 'glass', LAMP, glass)).setTranslation([0, -0.5, 0]),
		moving: document.createNode('moving').setMesh(addSquare(document, 'moving', FLOOR, wood)).setTranslation([3, 0, 0]),
		camera: document.createNode('camera').setCamera(document.createCamera('eye').setType('perspective')),
	};
	nodes.left.setExtras({ id: 7 });
	const scene = document.createScene('scene');
	for (const node of Object.values(nodes)) scene.addChild(node);
	document.getRoot().setDefaultScene(scene);
	const accessor = (type, array) => document.createAccessor().setType(type).setArray(new Float32Array(array));
	const sampler = document.createAnimationSampler().setInput(accessor('SCALAR', [0, 1]));
	sampler.setOutput(accessor('VEC3', [3, 0, 0, 3, 1, 0]));
	const channel = document.createAnimationChannel().setTargetNode(nodes.moving).setTargetPath('translation').setSampler(sampler);
	document.createAnimation('lift').addSampler(sampler).addChannel(channel);
	for (const each of document.getRoot().listAccessors()) each.setBuffer(document.getRoot().listBuffers()[0]);
	return document;
}

/** A floor that varies under a lamp: what moves over it, a tinted pane, a veil, an unlit card, and a lamp that is hidden. */
export function switching() {
	const document = new Document();
	const paint = (name, rgb, alpha = 1) => document.createMaterial(name).setMetallicFactor(0).setBaseColorFactor([...rgb, alpha]);
	const strength = document.createExtension(KHRMaterialsEmissiveStrength).createEmissiveStrength().setEmissiveStrength(4);
	const lit = paint('lamp', [0, 0, 0]).setEmissiveFactor([1, 1, 1]).setExtension('KHR_materials_emissive_strength', strength);
	const clear = document.createExtension(KHRMaterialsTransmission).createTransmission().setTransmissionFactor(0.8);
	const pane = paint('pane', [0.9, 0.5, 0.2]).setDoubleSided(true).setExtension('KHR_materials_transmission', clear);
	const veil = paint('veil', [0.5, 0.5, 0.5], 0.4).setDoubleSided(true).setAlphaMode('BLEND');
	const unlit = document.createExtension(KHRMaterialsUnlit);
	const card = paint('card', [1, 0, 0]).setExtension('KHR_materials_unlit', unlit.createUnlit());
	const grey = paint('grey', [0.6, 0.6, 0.6]);
	const scene = document.createScene('scene');
	const add = (name, positions, material, place) => {
		const node = document.createNode(name).setMesh(addSquare(document, name, positions, material)).setTranslation(place);
		scene.addChild(node);
		return node;
	};
	const floor = add('floor', FLOOR, grey, [0, 0, 0]).getMesh().listPrimitives()[0];
	const variants = document.createExtension(KHRMaterialsVariants);
	const mapping = variants.createMapping().setMaterial(paint('red', [1, 0, 0])).addVariant(variants.createVariant('red'));
	floor.setExtension('KHR_materials_variants', variants.createMappingList().addMapping(mapping));
	add('lamp', LAMP, lit, [0, 1, 0]);
	add('pane', FLOOR, pane, [0, 1.5, 0]);
	add('veil', FLOOR, veil, [0.5, 1, 0]);
	add('card', FLOOR, card, [0, 0.8, 0.7]);
	const moving = add('moving', FLOOR, grey, [-0.5, 0.4, -0.5]).setScale([0.8, 1, 0.8]);
	const visibility = document.createExtension(KHRNodeVisibility).createVisibility().setVisible(false);
	add('hidden', LAMP, lit, [0, -0.5, 0]).setExtension('KHR_node_visibility', visibility);
	const accessor = (type, array) => document.createAccessor().setType(type).setArray(new Float32Array(array));
	const sampler = document.createAnimationSampler().setInput(accessor('SCALAR', [0, 1])).setOutput(accessor('VEC3', [0, 0, 0, 3, 1, 0]));
	const channel = document.createAnimationChannel().setTargetNode(moving).setTargetPath('translation').setSampler(sampler);
	document.createAnimation('lift').addSampler(sampler).addChannel(channel);
	document.getRoot().setDefaultScene(scene);
	for (const each of document.getRoot().listAccessors()) each.setBuffer(document.getRoot().listBuffers()[0]);
	return document;
}

/** Over the area of a primitive's triangles. */
export function meanRadiance(primitive) {
	const [positions, radiance] = ['POSITION', '_RADIOSITY'].map((name) => primitive.getAttribute(name).getArray());
	const indices = primitive.getIndices().getArray();
	const [sum, corner] = [[0, 0, 0], (v) => [...positions.slice(3 * v, 3 * v + 3)]];
	let area = 0;
	for (let t = 0; t < indices.length; t += 3) {
		const [a, b, c] = [...indices.slice(t, t + 3)];
		const [u, v] = [corner(b), corner(c)].map((p) => p.map((x, k) => x - corner(a)[k]));
		const own = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
		area += own;
		for (let k = 0; k < 3; k++) sum[k] += (own * (radiance[3 * a + k] + radiance[3 * b + k] + radiance[3 * c + k])) / 3;
	}
	return sum.map((x) => x / area);
}

/** A wavy square of 2 n^2 triangles with texture coordinates, in one mesh. */
export function large(n) {
	const document = new Document();
	const count = (n + 1) * (n + 1);
	const [positions, texcoords, indices] = [new Float32Array(3 * count), new Float32Array(2 * count), new Uint32Array(6 * n * n)];
	for (let v = 0; v < count; v++) {
		const [x, z] = [(v % (n + 1)) / n, Math.floor(v / (n + 1)) / n];
		positions.set([x, 0.01 * Math.sin(40 * x) * Math.sin(30 * z), z], 3 * v);
		texcoords.set([x, z], 2 * v);
	}
	for (let i = 0; i < n * n; i++) {
		const a = i + Math.floor(i / n);
		indices.set([a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2], 6 * i);
	}
	const accessor = (type, array) => document.createAccessor().setType(type).setArray(array);
	const primitive = document.createPrimitive().setMaterial(document.createMaterial('grey').setMetallicFactor(0));
	primitive.setIndices(accessor('SCALAR', indices)).setAttribute('POSITION', accessor('VEC3', positions));
	primitive.setAttribute('TEXCOORD_0', accessor('VEC2', texcoords));
	document.createScene().addChild(document.createNode('large').setMesh(document.createMesh().addPrimitive(primitive)));
	return document;
}

/** A floor and a wall under a point light, a spot and a directional light, each of its own colour, the last turned. */
export function lit() {
	const document = new Document();
	const grey = document.createMaterial('grey').setMetallicFactor(0).setBaseColorFactor([0.5, 0.6, 0.7, 1]);
	const lights = document.createExtension(KHRLightsPunctual);
	const wall = new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
	const add = (type, color, intensity) => lights.createLight(type).setType(type).setColor(color).setIntensity(intensity);
	const spot = add('spot', [0, 1, 0], 5).setInnerConeAngle(0.2).setOuterConeAngle(0.5);
	const down = [-Math.SQRT1_2, 0, 0, Math.SQRT1_2];
	const scene = document.createScene();
	scene.addChild(document.createNode('floor').setMesh(addSquare(document, 'floor', FLOOR, grey)));
	scene.addChild(document.createNode('wall').setMesh(addSquare(document, 'wall', wall, grey)));
	const name = 'KHR_lights_punctual';
	scene.addChild(document.createNode('bulb').setTranslation([0.3, 1, 0.3]).setExtension(name, add('point', [1, 0, 0], 2).setRange(4)));
	scene.addChild(document.createNode('lamp').setTranslation([0.7, 1, 0.7]).setRotation(down).setExtension(name, spot));
	scene.addChild(document.createNode('moon').setRotation(down).setExtension(name, add('directional', [0, 0, 1], 1)));
	document.getRoot().setDefaultScene(scene);
	return document;
}

/** Three lamps by GPU instancing over a floor. */
export function instanced() {
	const document = new Document();
	const lit = document.createMaterial('lamp').setEmissiveFactor([1, 1, 1]);
	const grey = document.createMaterial('grey').setMetallicFactor(0);
	const batch = document.createExtension(EXTMeshGPUInstancing).createInstancedMesh();
	batch.setAttribute('TRANSLATION', document.createAccessor().setType('VEC3').setArray(new Float32Array([0, 0, 0, 1, 0, 0, 2, 0, 0])));
	const lamps = document.createNode('lamps').setMesh(addSquare(document, 'lamp', LAMP, lit));
	lamps.setExtension('EXT_mesh_gpu_instancing', batch);
	const floor = document.createNode('floor').setMesh(addSquare(document, 'floor', FLOOR, grey));
	document.createScene().addChild(lamps).addChild(floor);
	for (const each of document.getRoot().listAccessors()) each.setBuffer(document.getRoot().listBuffers()[0]);
	return document;
}
