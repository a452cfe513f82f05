// SPDX-License-Identifier: MIT
// How does a page get its files? From folders of this machine, on 127.0.0.1, and from nowhere else.
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';

const TYPES = {
    '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm', '.glb': 'model/gltf-binary',
};

// mounts: folder by the first part of the path. Resolves to { url, close }.
export async function serve(mounts) {
    const server = createServer(async (request, response) => {
        try {
            const [, mount, ...rest] = decodeURIComponent(new URL(request.url, 'http://127.0.0.1').pathname).split('/');
            const path = join(mounts[mount], normalize(`/${rest.join('/')}`));
            const bytes = await readFile(path);
            response.writeHead(200, { 'Content-Type': TYPES[extname(path)] ?? 'application/octet-stream' }).end(bytes);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise(resolve => server.listen(0, '127.0.0.1', resolve));
    return { url: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}
