// SPDX-License-Identifier: MIT
// Does Draco's own decoder give the triangles that the same bake has without Draco?
//
//     node same_triangles.mjs PLAIN.glb DRACO.glb [BITS]
//
// Both are put on Draco's grid of positions (BITS, default 14) and paired, with their winding. A corner half-way between
// two grid points may be rounded to either, so corners may differ by one step.
// Prints how many are the same; exits 1 if one is not. Needs the npm package draco3d.
import { readFile } from 'node:fs/promises';
import draco3d from 'draco3d';

const [plainPath, dracoPath, bits = '14'] = process.argv.slice(2);
const steps = 2 ** Number(bits) - 1;
const decoder = await draco3d.createDecoderModule({});

async function open(path) {
    const bytes = await readFile(path);
    const length = bytes.readUInt32LE(12);
    return { json: JSON.parse(bytes.toString('utf8', 20, 20 + length)), bin: bytes.subarray(28 + length) };
}

function plainTriangles({ json, bin }, primitive) {
    const read = (index, type, width) => {
        const accessor = json.accessors[index];
        const view = json.bufferViews[accessor.bufferView];
        const start = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
        return new type(bin.buffer.slice(bin.byteOffset + start, bin.byteOffset + start + accessor.count * width * type.BYTES_PER_ELEMENT));
    };
    const indexType = json.accessors[primitive.indices].componentType === 5123 ? Uint16Array : Uint32Array;
    return { positions: read(primitive.attributes.POSITION, Float32Array, 3), indices: read(primitive.indices, indexType, 1) };
}

function dracoTriangles({ json, bin }, primitive) {
    const { bufferView, attributes } = primitive.extensions.KHR_draco_mesh_compression;
    const view = json.bufferViews[bufferView];
    const start = view.byteOffset ?? 0;
    const bytes = new Int8Array(bin.subarray(start, start + view.byteLength));
    const draco = new decoder.Decoder();
    const mesh = new decoder.Mesh();
    if (!draco.DecodeArrayToMesh(bytes, bytes.length, mesh).ok()) throw new Error('Draco cannot read it');
    const values = new decoder.DracoFloat32Array();
    draco.GetAttributeFloatForAllPoints(mesh, draco.GetAttributeByUniqueId(mesh, attributes.POSITION), values);
    const positions = Float32Array.from({ length: 3 * mesh.num_points() }, (_, i) => values.GetValue(i));
    const face = new decoder.DracoInt32Array();
    const indices = new Uint32Array(3 * mesh.num_faces());
    for (let f = 0; f < mesh.num_faces(); f++) {
        draco.GetFaceFromMesh(mesh, f, face);
        for (let k = 0; k < 3; k++) indices[3 * f + k] = face.GetValue(k);
    }
    return { positions, indices };
}

// The grid that Draco quantises to: from the least corner, one range for all three axes.
function gridOf({ positions }) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    positions.forEach((value, i) => {
        low[i % 3] = Math.min(low[i % 3], value);
        high[i % 3] = Math.max(high[i % 3], value);
    });
    return { low, step: Math.max(...high.map((value, k) => value - low[k])) / steps };
}

// Each triangle as nine grid numbers.
function triangles(mesh, grid) {
    return Array.from({ length: mesh.indices.length / 3 }, (_, t) =>
        [0, 1, 2].flatMap((k) =>
            [0, 1, 2].map((c) => Math.round((mesh.positions[3 * mesh.indices[3 * t + k] + c] - grid.low[c]) / grid.step)),
        ),
    );
}

// Cells of a few steps, so that equals are in the same cell or in one beside it.
const cell = (triangle, k) => Math.floor((triangle[k] + triangle[k + 3] + triangle[k + 6]) / 24);

function isSame(a, b) {
    return [0, 3, 6].some((turn) => a.every((value, i) => Math.abs(value - b[(i + turn) % 9]) <= 1));
}

// Takes an equal of the triangle out of the cells; false if there is none.
function take(cells, triangle) {
    const [x, y, z] = [0, 1, 2].map((k) => cell(triangle, k));
    for (let n = 0; n < 27; n++) {
        const list = cells.get(`${x + (n % 3) - 1},${y + (Math.floor(n / 3) % 3) - 1},${z + Math.floor(n / 9) - 1}`) ?? [];
        const at = list.findIndex((other) => isSame(triangle, other));
        if (at < 0) continue;
        list.splice(at, 1);
        return true;
    }
    return false;
}

const plain = await open(plainPath);
const draco = await open(dracoPath);
let same = 0;
let different = 0;
for (const [m, mesh] of plain.json.meshes.entries())
    for (const [p, primitive] of mesh.primitives.entries()) {
        const before = plainTriangles(plain, primitive);
        const after = dracoTriangles(draco, draco.json.meshes[m].primitives[p]);
        const grid = gridOf(before);
        const cells = new Map();
        const found = triangles(after, grid);
        for (const triangle of found) {
            const name = [0, 1, 2].map((k) => cell(triangle, k)).join(',');
            cells.set(name, [...(cells.get(name) ?? []), triangle]);
        }
        const wanted = triangles(before, grid);
        const missing = wanted.filter((triangle) => !take(cells, triangle)).length;
        same += wanted.length - missing;
        different += missing + Math.abs(found.length - wanted.length);
    }
console.log(`${same} triangles the same, ${different} different`);
process.exit(same > 0 && different === 0 ? 0 : 1);
