// SPDX-License-Identifier: MIT
// A worker that says when its bake, which does not end, is under way.

import { parentPort } from 'node:worker_threads';
import { bakeScene } from 'hemibake-gltf-transform';
import { squares } from './rooms.mjs';

let told = false;
await bakeScene(squares(), {
	elementSize: 0.01, patchSize: 0.02, unshot: 1e-9,
	onProgress() {
		if (!told) parentPort.postMessage('baking');
		told = true;
	},
});
