// SPDX-License-Identifier: MIT
// Does the Khronos validator accept these files, and does Draco's own decoder find what the accessors promise?
//
//     node validate.mjs FILE.glb|FILE.gltf ...
//
// Prints one line a file; exits 1 if any has an error. Needs the npm packages gltf-validator and draco3d.
import { readFile } from 'node:fs/promises';
import { dirname, resolve } from 'node:path';
import validator from 'gltf-validator';
import draco3d from 'draco3d';

const decoder = await draco3d.createDecoderModule({});

// The JSON and the first buffer of a .glb or .gltf.
async function open(path) {
    const bytes = await readFile(path);
    if (bytes.toString('latin1', 0, 4) !== 'glTF') {
        const json = JSON.parse(bytes.toString('utf8'));
        const uri = json.buffers?.[0]?.uri;
        const bin = uri?.startsWith('data:')
            ? Buffer.from(uri.slice(uri.indexOf(',') + 1), 'base64')
            : uri && (await readFile(resolve(dirname(path), decodeURIComponent(uri))));
        return { bytes, json, bin };
    }
    const length = bytes.readUInt32LE(12);
    return { bytes, json: JSON.parse(bytes.toString('utf8', 20, 20 + length)), bin: bytes.subarray(28 + length) };
}

// Points and faces of Draco bytes, and the components of each attribute by its unique id.
function decode(bytes, ids) {
    const draco = new decoder.Decoder();
    const mesh = new decoder.Mesh();
    const status = draco.DecodeArrayToMesh(new Int8Array(bytes), bytes.length, mesh);
    if (!status.ok()) throw new Error(`Draco: ${status.error_msg()}`);
    const components = {};
    for (const [name, id] of Object.entries(ids))
        components[name] = draco.GetAttributeByUniqueId(mesh, id)?.num_components();
    const found = { points: mesh.num_points(), faces: mesh.num_faces(), components };
    decoder.destroy(mesh);
    decoder.destroy(draco);
    return found;
}

const widths = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

// What is wrong with one Draco primitive.
function checkPrimitive({ json, bin }, primitive, where) {
    const extension = primitive.extensions.KHR_draco_mesh_compression;
    const view = json.bufferViews[extension.bufferView];
    const start = view.byteOffset ?? 0;
    const found = decode(bin.subarray(start, start + view.byteLength), extension.attributes);
    const problems = [];
    const expect = (what, value, expected) => {
        if (value !== expected) problems.push(`${where}: ${what} is ${value}, the accessor says ${expected}`);
    };
    expect('faces * 3', found.faces * 3, json.accessors[primitive.indices].count);
    for (const name of Object.keys(extension.attributes)) {
        const accessor = json.accessors[primitive.attributes[name]];
        expect(`points (${name})`, found.points, accessor.count);
        expect(`components of ${name}`, found.components[name], widths[accessor.type]);
    }
    return problems;
}

function checkDraco(asset) {
    const problems = [];
    let count = 0;
    for (const [m, mesh] of (asset.json.meshes ?? []).entries())
        for (const [p, primitive] of mesh.primitives.entries()) {
            if (!primitive.extensions?.KHR_draco_mesh_compression) continue;
            count++;
            problems.push(...checkPrimitive(asset, primitive, `meshes[${m}].primitives[${p}]`));
        }
    return { count, problems };
}

async function check(path) {
    const asset = await open(path);
    const report = await validator.validateBytes(new Uint8Array(asset.bytes), {
        uri: path,
        maxIssues: 100,
        externalResourceFunction: async (uri) => new Uint8Array(await readFile(resolve(dirname(path), decodeURIComponent(uri)))),
    });
    const draco = checkDraco(asset);
    const { numErrors, numWarnings, numInfos, messages } = report.issues;
    console.log(`${path}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos; ` +
        `${draco.count} Draco primitives, ${draco.problems.length} problems`);
    for (const message of messages.filter((m) => m.severity < 2)) console.log(`  ${message.code} ${message.pointer}: ${message.message}`);
    for (const problem of draco.problems) console.log(`  ${problem}`);
    return numErrors + draco.problems.length;
}

const paths = process.argv.slice(2);
if (paths.length === 0) {
    console.error('usage: node validate.mjs FILE ...');
    process.exit(2);
}
let failures = 0;
for (const path of paths)
    failures += await check(path).catch((error) => {
        console.log(`${path}: ${error.message}`);
        return 1;
    });
process.exit(failures > 0 ? 1 : 0);
