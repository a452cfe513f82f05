// SPDX-License-Identifier: MIT
// PlayCanvas with the exact curve of sRGB in the place of its power 1 / 2.2. Settings: "defaults", without it;
// "tone-mapped", an application that maps tones; "tone-mapped-off", the same with the baked materials taken out of it.
import {
    Application, Asset, Color, FILLMODE_NONE, SHADERLANGUAGE_GLSL, ShaderChunks, TONEMAP_ACES, WasmModule,
} from 'playcanvas';
import { BACKGROUND, DRACO, HEIGHT, SRGB_OUTPUT, WIDTH, addCanvas, presented } from './page.mjs';

function load(app, url) {
    return new Promise((resolve, reject) => {
        const asset = new Asset('baked', 'container', { url });
        asset.once('load', resolve);
        asset.once('error', reject);
        app.assets.add(asset);
        app.assets.load(asset);
    });
}

// Replaces the first gammaCorrectOutput of the chunk, that of GAMMA == SRGB.
function encodeExactly(device) {
    const chunks = ShaderChunks.get(device, SHADERLANGUAGE_GLSL), gamma = chunks.get('gammaPS');
    chunks.set('gammaPS', gamma.replace(/vec3 gammaCorrectOutput[^}]*}/, SRGB_OUTPUT));
}

export async function draw(url, setting) {
    WasmModule.setConfig('DracoDecoderModule', {
        glueUrl: DRACO + 'draco_wasm_wrapper.js', wasmUrl: DRACO + 'draco_decoder.wasm', fallbackUrl: DRACO + 'draco_decoder.js',
    });
    const app = new Application(addCanvas(), { graphicsDeviceOptions: { antialias: false, preserveDrawingBuffer: true } });
    app.setCanvasFillMode(FILLMODE_NONE, WIDTH, HEIGHT);
    if (setting !== 'defaults') encodeExactly(app.graphicsDevice);
    app.start();
    const asset = await load(app, url);
    const entity = asset.resource.instantiateRenderEntity();
    app.root.addChild(entity);
    const [camera] = entity.findComponents('camera');
    camera.enabled = true;
    camera.clearColor = new Color(BACKGROUND / 255, BACKGROUND / 255, BACKGROUND / 255);
    if (setting?.startsWith('tone-mapped')) camera.toneMapping = TONEMAP_ACES;
    if (setting === 'tone-mapped-off')
        for (const { resource } of asset.resource.materials) { resource.useTonemap = false; resource.update(); }
    for (let i = 0; i < 3; i++) await new Promise(resolve => app.once('frameend', resolve));
    await presented();
}
