// SPDX-License-Identifier: MIT
// How does light get back into a Document? New vertices with COLOR_0, and unlit materials; all else stays as it is.

import { KHRMaterialsUnlit } from '@gltf-transform/extensions';
import { inTurns, texcoordNames } from './document_scene.mjs';

function makeAccessor(document, type, array, normalized = false) {
	const buffer = document.getRoot().listBuffers()[0] ?? document.createBuffer();
	return document.createAccessor().setBuffer(buffer).setType(type).setArray(array).setNormalized(normalized);
}

/** Texture coordinates of the new vertices: the mean of their source triangle's corners. */
async function interpolate(source, indices, baked) {
	const out = new Float32Array(2 * baked.sourceTriangles.length);
	await inTurns(baked.sourceTriangles.length, (v) => {
		for (let corner = 0; corner < 3; corner++) {
			const from = 2 * indices[3 * baked.sourceTriangles[v] + corner];
			const weight = baked.sourceWeights[3 * v + corner];
			out[2 * v] += weight * source[from];
			out[2 * v + 1] += weight * source[from + 1];
		}
	});
	return out;
}

async function newTexcoords(document, primitive, desc, baked) {
	if (!baked.sourceTriangles) return {};
	const made = {};
	for (const name of texcoordNames(primitive)) {
		const source = primitive.getAttribute(name).getArray();
		made[name] = makeAccessor(document, 'VEC2', await interpolate(source, desc.indices, baked));
	}
	return made;
}

async function newColors(document, baked, colorFormat) {
	if (colorFormat === 'u16norm') return makeAccessor(document, 'VEC4', baked.colors, true);
	const count = baked.colors.length / 4;
	const rgb = new Float32Array(3 * count);
	await inTurns(count, (v) => {
		for (let c = 0; c < 3; c++) rgb[3 * v + c] = baked.colors[4 * v + c] / 65535;
	});
	return makeAccessor(document, 'VEC3', rgb);
}

/** The baked geometry in place of the old; false if nothing is left of the primitive. */
export async function replaceGeometry(document, { primitive, mesh }, desc, baked, options) {
	if (baked.indices.length === 0) {
		mesh.removePrimitive(primitive);
		return false;
	}
	const attributes = {
		POSITION: makeAccessor(document, 'VEC3', baked.positions),
		COLOR_0: await newColors(document, baked, options.colorFormat),
		...(await newTexcoords(document, primitive, desc, baked)),
	};
	if (options.sceneLinear) attributes._RADIOSITY = makeAccessor(document, 'VEC3', baked.radiance);
	if (options.vertexErrors) attributes._ERROR = makeAccessor(document, 'SCALAR', baked.errors);
	for (const name of primitive.listSemantics()) primitive.setAttribute(name, null);
	for (const [name, accessor] of Object.entries(attributes)) primitive.setAttribute(name, accessor);
	const short = baked.positions.length / 3 <= 65535;
	primitive.setIndices(makeAccessor(document, 'SCALAR', short ? new Uint16Array(baked.indices) : baked.indices));
	primitive.setExtension('KHR_materials_variants', null);
	return true;
}

/** Disposes of those of the old accessors and materials, and their textures, that nothing uses any more. */
export function disposeUnused(document, old) {
	const root = document.getRoot();
	const isUnused = (property) => property.listParents().every((parent) => parent === root);
	for (const property of old) {
		if (!isUnused(property)) continue;
		const textures = property.propertyType === 'Material' ? document.getGraph().listChildren(property) : [];
		property.dispose();
		for (const texture of textures) if (texture.propertyType === 'Texture' && isUnused(texture)) texture.dispose();
	}
}

/** A copy that shows light and nothing else; textured: with its base colour texture, which multiplies the light. */
export function unlitMaterial(document, source, textured) {
	const unlit = document.createExtension(KHRMaterialsUnlit).createUnlit();
	const copy = source ? source.clone() : document.createMaterial();
	for (const extension of copy.listExtensions()) {
		if (extension.extensionName.startsWith('KHR_materials_')) copy.setExtension(extension.extensionName, null);
	}
	copy.setEmissiveFactor([0, 0, 0]).setEmissiveTexture(null).setNormalTexture(null).setOcclusionTexture(null);
	copy.setMetallicRoughnessTexture(null).setMetallicFactor(0).setRoughnessFactor(0.9).setDoubleSided(false);
	copy.setBaseColorFactor([1, 1, 1, source ? source.getBaseColorFactor()[3] : 1]);
	if (!textured) copy.setBaseColorTexture(null).setAlphaMode('OPAQUE');
	return copy.setExtension('KHR_materials_unlit', unlit);
}
