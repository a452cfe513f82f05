// SPDX-License-Identifier: MIT
// Which parts of a Document can be baked, and how do they look as a scene of the ABI?

import { setImmediate } from 'node:timers/promises';
import { Primitive } from '@gltf-transform/core';
import { convertPrimitiveToTriangles, dequantizePrimitive } from '@gltf-transform/functions';

const { TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN } = Primitive.Mode;

/** visit(node) for the nodes of the scene that are shown, parents first: not those that KHR_node_visibility hides. */
function traverseShown(document, visit) {
	const root = document.getRoot();
	const walk = (node) => {
		if (node.getExtension('KHR_node_visibility')?.getVisible() === false) return;
		visit(node);
		node.listChildren().forEach(walk);
	};
	(root.getDefaultScene() ?? root.listScenes()[0])?.listChildren().forEach(walk);
}

/** Why a node cannot be baked, or undefined. */
function nodeFault(node) {
	if (node.getSkin()) return 'it is skinned';
	if (node.getExtension('EXT_mesh_gpu_instancing')) return 'it is instanced on the GPU; uninstance() it first';
}

/** Alpha that only a picture or COLOR_0 knows, which are not read here. */
function hidesAlpha(primitive) {
	const material = primitive.getMaterial();
	if (material?.getAlphaMode() !== 'BLEND') return false;
	return material.getBaseColorTexture() !== null || primitive.getAttribute('COLOR_0')?.getElementSize() === 4;
}

function primitiveFault(primitive) {
	if (![TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN].includes(primitive.getMode())) return 'it has no triangles';
	if (!primitive.getAttribute('POSITION')) return 'it has no positions';
	if (primitive.listTargets().length > 0) return 'it is morphed';
	if (hidesAlpha(primitive)) return 'its material is blended by a picture or by vertices';
}

/** Why a surface stands in the way of light and stays as it is, or undefined. */
function staysFor(material) {
	if (material?.getExtension('KHR_materials_unlit')) return 'it is unlit';
	if (passes(material).some((share) => share > 0)) return 'light passes through it';
}

/** Names of texture coordinates in the order of their numbers. */
export function texcoordNames(primitive) {
	return primitive
		.listSemantics()
		.filter((name) => name.startsWith('TEXCOORD_'))
		.sort((a, b) => Number(a.slice(9)) - Number(b.slice(9)));
}

/**
 * One entry for each node of the scene and each primitive of its mesh that can be baked, in the order of a walk through the
 * scene. Each such node gets a mesh of its own, since the light on it is its own.
 */
export function listBakeable(document, logger) {
	const found = [];
	traverseShown(document, (node) => {
		const mesh = node.getMesh();
		if (!mesh) return;
		const name = node.getName() || mesh.getName();
		const fault = nodeFault(node);
		if (fault) return logger.warn(`bake: node '${name}' is passed through: ${fault}`);
		found.push(...bakeableOf(node, separateMesh(node, mesh), name, logger));
	});
	return found;
}

/** The mesh, or a copy of it while another node shows it too. */
function separateMesh(node, mesh) {
	const others = mesh.listParents().filter((parent) => parent.propertyType === 'Node').length;
	if (others < 2) return mesh;
	const own = mesh.clone();
	for (const primitive of own.listPrimitives()) own.removePrimitive(primitive).addPrimitive(primitive.clone());
	node.setMesh(own);
	return own;
}

function bakeableOf(node, mesh, name, logger) {
	const found = [];
	for (const primitive of mesh.listPrimitives()) {
		const fault = primitiveFault(primitive);
		const stays = staysFor(primitive.getMaterial());
		if (fault) logger.warn(`bake: a primitive of '${name}' is passed through: ${fault}`);
		else found.push({ node, mesh, primitive, name, stays });
		if (!fault && stays) logger.warn(`bake: a primitive of '${name}' stays as it is, in the way of light: ${stays}`);
	}
	return found;
}

/** Lights of KHR_lights_punctual at the nodes of the scene. */
export function listLights(document) {
	const found = [];
	traverseShown(document, (node) => {
		const light = node.getExtension('KHR_lights_punctual');
		if (light) found.push(lightDesc(node, light));
	});
	return found;
}

function lightDesc(node, light) {
	const world = node.getWorldMatrix();
	return {
		name: node.getName() || light.getName(),
		kind: light.getType(),
		intensity: light.getColor().map((c) => c * light.getIntensity()),
		position: world.slice(12, 15),
		direction: world.slice(8, 11).map((x) => -x),
		innerCone: light.getInnerConeAngle(),
		outerCone: light.getOuterConeAngle(),
		range: light.getRange() ?? 0,
	};
}

/** The sun's own, in degrees. */
const SUN_ANGLE = 0.533;

/** As the command's --sun: azimuth from -z over +x, elevation, lux, angle; in degrees. */
export function sunDesc([azimuth, elevation, lux, angle = SUN_ANGLE]) {
	const [a, e, diameter] = [azimuth, elevation, angle].map((degrees) => (degrees * Math.PI) / 180);
	return {
		name: 'sun',
		kind: 'directional',
		intensity: [lux, lux, lux],
		direction: [-Math.cos(e) * Math.sin(a), -Math.sin(e), Math.cos(e) * Math.cos(a)],
		angularDiameter: diameter,
	};
}

// ---- long loops ----------------------------------------------------------------------------------------------------

const TURN = 8192;

/** work(i) for i below count, with a turn for others every few thousand: the event loop is never held for long. */
export async function inTurns(count, work) {
	for (let first = 0; first < count; first += TURN) {
		const end = Math.min(first + TURN, count);
		for (let i = first; i < end; i++) work(i);
		if (end < count) await setImmediate();
	}
}

// ---- descs -------------------------------------------------------------------------------------------------------------

/** Whatever the accessor holds, as floats. */
async function floats(accessor) {
	const array = accessor.getArray();
	if (array instanceof Float32Array && !accessor.getNormalized()) return array;
	const width = accessor.getElementSize();
	const out = new Float32Array(accessor.getCount() * width);
	const element = [];
	await inTurns(accessor.getCount(), (i) => out.set(accessor.getElement(i, element), i * width));
	return out;
}

function indices(primitive) {
	const accessor = primitive.getIndices();
	const array = accessor?.getArray();
	if (accessor) return array instanceof Uint32Array ? array : new Uint32Array(array);
	return Uint32Array.from({ length: primitive.getAttribute('POSITION').getCount() }, (_, i) => i);
}

/** All texture coordinates of a vertex side by side. */
async function interleave(accessors) {
	const arrays = await Promise.all(accessors.map(floats));
	const out = new Float32Array(arrays.length * (arrays[0]?.length ?? 0));
	const stride = 2 * arrays.length;
	for (const [set, array] of arrays.entries()) {
		await inTurns(array.length, (i) => (out[stride * (i >> 1) + 2 * set + (i & 1)] = array[i]));
	}
	return out;
}

export async function meshDesc({ node, primitive, name }, material) {
	if (primitive.getMode() !== TRIANGLES) convertPrimitiveToTriangles(primitive);
	dequantizePrimitive(primitive, /^(POSITION|NORMAL|TEXCOORD)(_\d+)?$/);
	const normal = primitive.getAttribute('NORMAL');
	const texcoords = texcoordNames(primitive);
	const desc = {
		name,
		positions: await floats(primitive.getAttribute('POSITION')),
		indices: indices(primitive),
		normals: normal ? await floats(normal) : undefined,
		material,
		transform: Array.from(node.getWorldMatrix()),
	};
	if (texcoords.length > 0) {
		desc.attributeCount = 2 * texcoords.length;
		desc.attributes = await interleave(texcoords.map((name) => primitive.getAttribute(name)));
	}
	return desc;
}

/** What gets straight through a material by its factors, as the command has it: what alpha leaves, and glass. */
function passes(material) {
	if (!material) return [0, 0, 0];
	const cover = material.getAlphaMode() === 'BLEND' ? Math.min(Math.max(material.getAlpha(), 0), 1) : 1;
	const straight = material.getExtension('KHR_materials_transmission')?.getTransmissionFactor() ?? 0;
	const plain = 1 - Math.min(Math.max(material.getMetallicFactor(), 0), 1);
	return material.getBaseColorFactor().slice(0, 3).map((c) => 1 - cover + cover * plain * straight * Math.min(Math.max(c, 0), 1));
}

/** Metals reflect by half their squared roughness, as the command has it; glTF's default material is a rough white one. */
export function materialDesc(material) {
	if (!material) return { name: 'default material', reflectance: [0.5, 0.5, 0.5], emission: [0, 0, 0], doubleSided: false };
	const metal = Math.min(Math.max(material.getMetallicFactor(), 0), 1);
	const rough = Math.min(Math.max(material.getRoughnessFactor(), 0), 1);
	const straight = material.getExtension('KHR_materials_transmission')?.getTransmissionFactor() ?? 0;
	const cover = material.getAlphaMode() === 'BLEND' ? Math.min(Math.max(material.getAlpha(), 0), 1) : 1;
	const diffuse = cover * ((1 - metal) * (1 - straight) + (metal * rough * rough) / 2);
	if (material.getExtension('KHR_materials_unlit')) return { name: material.getName(), reflectance: [0, 0, 0], emission: [0, 0, 0], transmission: passes(material) };
	const strength = material.getExtension('KHR_materials_emissive_strength')?.getEmissiveStrength() ?? 1;
	return {
		name: material.getName(),
		reflectance: material.getBaseColorFactor().slice(0, 3).map((c) => Math.min(Math.max(c, 0), 1) * diffuse),
		emission: material.getEmissiveFactor().map((c) => Math.max(c * strength, 0)),
		transmission: passes(material),
		doubleSided: material.getDoubleSided(),
	};
}
