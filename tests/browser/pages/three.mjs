// SPDX-License-Identifier: MIT
// three.js with nothing but its defaults. Settings: "tone-mapped", an application that maps tones; "tone-mapped-off",
// the same with the baked materials taken out of it.
import { ACESFilmicToneMapping, Color, SRGBColorSpace, Scene, WebGLRenderer } from 'three';
import { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { BACKGROUND, DRACO, HEIGHT, WIDTH, addCanvas, presented } from './page.mjs';

export async function draw(asset, setting) {
    const renderer = new WebGLRenderer({ canvas: addCanvas(), preserveDrawingBuffer: true });
    renderer.setSize(WIDTH, HEIGHT, false);
    if (setting?.startsWith('tone-mapped')) renderer.toneMapping = ACESFilmicToneMapping;
    const loader = new GLTFLoader().setDRACOLoader(new DRACOLoader().setDecoderPath(DRACO));
    const gltf = await loader.loadAsync(asset);
    if (setting === 'tone-mapped-off') gltf.scene.traverse(node => { if (node.isMesh) node.material.toneMapped = false; });
    const scene = new Scene();
    scene.background = new Color().setRGB(BACKGROUND / 255, BACKGROUND / 255, BACKGROUND / 255, SRGBColorSpace);
    scene.add(gltf.scene);
    renderer.render(scene, gltf.cameras[0]);
    await presented();
}
