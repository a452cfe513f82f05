// SPDX-License-Identifier: MIT
// What do all viewers draw on, and when is it on the screen?

export const WIDTH = 640, HEIGHT = 480;
export const DRACO = '/draco/';
export const BACKGROUND = 241; // code value, as in the command's pictures

export function addCanvas() {
    const canvas = document.createElement('canvas');
    canvas.width = WIDTH;
    canvas.height = HEIGHT;
    document.body.append(canvas);
    return canvas;
}

// IEC 61966-2-1 in GLSL, for a viewer that has the power 1 / 2.2 instead.
export const SRGB_OUTPUT = `
    vec3 gammaCorrectOutput(vec3 color) {
        vec3 curve = 1.055 * pow(color, vec3(1.0 / 2.4)) - 0.055;
        return mix(curve, 12.92 * color, vec3(lessThanEqual(color, vec3(0.0031308))));
    }`;

// After the browser has composited what was drawn.
export async function presented() {
    for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame);
}
