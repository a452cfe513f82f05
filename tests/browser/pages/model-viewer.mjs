// SPDX-License-Identifier: MIT
// <model-viewer> with its defaults but for the camera: it knows none of glTF's. Setting: "tone-mapped", another tone
// mapping than its default.
import '@google/model-viewer';
import { BACKGROUND, DRACO, presented } from './page.mjs';

// The cameras of the board and of the room, by the asset's name.
const CAMERAS = {
    room: { 'camera-target': '0.3m 1.1m 0m', 'camera-orbit': '0rad 1.5707963rad 3.4m', 'field-of-view': '0.7rad' },
    board: { 'camera-target': '0m 0m 0m', 'camera-orbit': '0rad 1.5707963rad 6m', 'field-of-view': '0.75rad' },
};
const LIMITS = {
    'min-camera-orbit': 'auto auto 0m', 'max-camera-orbit': 'auto auto 100m', 'min-field-of-view': '1deg',
    'max-field-of-view': '90deg', 'interaction-prompt': 'none',
};

export async function draw(asset, setting) {
    globalThis.ModelViewerElement = { dracoDecoderLocation: DRACO };
    const viewer = document.createElement('model-viewer');
    const camera = asset.includes('room') ? CAMERAS.room : CAMERAS.board;
    for (const [name, value] of Object.entries({ ...camera, ...LIMITS })) viewer.setAttribute(name, value);
    if (setting === 'tone-mapped') viewer.setAttribute('tone-mapping', 'aces');
    viewer.style.backgroundColor = `rgb(${BACKGROUND} ${BACKGROUND} ${BACKGROUND})`;
    const loaded = new Promise((resolve, reject) => {
        viewer.addEventListener('load', resolve, { once: true });
        viewer.addEventListener('error', ({ detail }) => reject(detail.sourceError ?? new Error(detail.type)), { once: true });
    });
    viewer.src = asset;
    document.body.append(viewer);
    await loaded;
    viewer.jumpCameraToGoal();
    await new Promise(resolve => setTimeout(resolve, 500)); // the poster fades
    await presented();
}
