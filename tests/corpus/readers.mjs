// SPDX-License-Identifier: MIT
// What do the Khronos validator and glTF-Transform say of these files?
//
//     node readers.mjs <LIST     one path a line; prints one JSON object a line
//
// errors: codes and places of the validator; triangles, vertices: of all primitives as glTF-Transform decodes them.
import { readFile } from 'node:fs/promises';
import { dirname, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import validator from 'gltf-validator';
import draco3d from 'draco3dgltf';
import { Logger, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { MeshoptDecoder } from 'meshoptimizer';

const io = new NodeIO()
    .setLogger(new Logger(Logger.Verbosity.SILENT))
    .registerExtensions(ALL_EXTENSIONS)
    .registerDependencies({
        'draco3d.decoder': await draco3d.createDecoderModule(),
        'meshopt.decoder': await MeshoptDecoder.ready.then(() => MeshoptDecoder),
    });

async function validate(path) {
    const bytes = new Uint8Array(await readFile(path));
    const external = async (uri) => new Uint8Array(await readFile(resolve(dirname(path), decodeURIComponent(uri))));
    const report = await validator.validateBytes(bytes, { externalResourceFunction: external, maxIssues: 1000 });
    return report.issues.messages.filter((m) => m.severity === 0).map((m) => `${m.code} ${m.pointer ?? ''}`);
}

function count(document) {
    let triangles = 0, vertices = 0;
    const root = document.getRoot();
    for (const mesh of root.listMeshes())
        for (const primitive of mesh.listPrimitives()) {
            const positions = primitive.getAttribute('POSITION');
            const corners = primitive.getIndices()?.getCount() ?? positions?.getCount() ?? 0;
            for (const name of primitive.listSemantics())
                if (primitive.getAttribute(name).getCount() !== positions.getCount()) throw new Error(`${name} differs in count`);
            if (primitive.getMode() === 4) triangles += corners / 3;
            vertices += positions?.getCount() ?? 0;
        }
    return { triangles, vertices, nodes: root.listNodes().length, meshes: root.listMeshes().length };
}

for await (const path of createInterface({ input: process.stdin })) {
    const said = { path };
    try {
        said.errors = await validate(path);
    } catch (error) {
        said.errors = [`validator: ${error.message}`];
    }
    try {
        Object.assign(said, count(await io.read(path)));
    } catch (error) {
        said.unreadable = error.message;
    }
    console.log(JSON.stringify(said));
}
