// SPDX-License-Identifier: MIT
// Babylon.js with useExactSrgbConversions; without it colours are encoded by the power 1 / 2.2. Settings: "defaults",
// without it; "tone-mapped", an application that maps tones; "tone-mapped-off", the same with image processing of their
// own for the baked materials.
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { DracoDecoder } from '@babylonjs/core/Meshes/Compression/dracoDecoder.js';
import { ImageProcessingConfiguration } from '@babylonjs/core/Materials/imageProcessingConfiguration.js';
import { AppendSceneAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { SceneLoaderFlags } from '@babylonjs/core/Loading/sceneLoaderFlags.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/core/Loading/loadingScreen.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import { BACKGROUND, DRACO, addCanvas, presented } from './page.mjs';

export async function draw(asset, setting) {
    DracoDecoder.DefaultConfiguration = {
        wasmUrl: DRACO + 'draco_wasm_wrapper.js', wasmBinaryUrl: DRACO + 'draco_decoder.wasm',
        fallbackUrl: DRACO + 'draco_decoder.js',
    };
    SceneLoaderFlags.ShowLoadingScreen = false;
    const engine = new Engine(addCanvas(), false, {
        preserveDrawingBuffer: true, useExactSrgbConversions: setting !== 'defaults',
    });
    const scene = new Scene(engine);
    await AppendSceneAsync(asset, scene);
    if (setting?.startsWith('tone-mapped')) {
        scene.imageProcessingConfiguration.toneMappingEnabled = true;
        scene.imageProcessingConfiguration.toneMappingType = ImageProcessingConfiguration.TONEMAPPING_ACES;
    }
    if (setting === 'tone-mapped-off')
        for (const material of scene.materials) material.imageProcessingConfiguration = new ImageProcessingConfiguration();
    scene.clearColor = new Color4(BACKGROUND / 255, BACKGROUND / 255, BACKGROUND / 255, 1);
    scene.activeCamera = scene.cameras[0];
    await scene.whenReadyAsync();
    scene.render();
    await presented();
}
