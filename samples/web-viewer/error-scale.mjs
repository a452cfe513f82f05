// SPDX-License-Identifier: MIT
// How is an error shown? As points on the bake, in the colours of `hemibake compare --heatmap`: black is right, and lighter is worse
// throughout, so that they are told apart without colour too. What is seen from behind is left out, as the bake itself is.
import { BufferAttribute, BufferGeometry, Color, LinearSRGBColorSpace, Points, ShaderMaterial } from 'three';

const STEPS = [[0, 0, 0.01], [0.09, 0.01, 0.15], [0.5, 0.04, 0.12], [0.95, 0.3, 0.02], [0.97, 0.95, 0.4]]
    .map((rgb) => new Color().setRGB(...rgb, LinearSRGBColorSpace));

export const SCALE = STEPS.map((color) => color.getStyle());

// Of the radius of all points, how wide one of them is for each that would fit along it.
const WIDTH = 6;

/** Linear rgb of shares of the full error, three numbers each. */
export function errorColors(shares) {
    const out = new Float32Array(3 * shares.length), color = new Color();
    shares.forEach((share, i) => {
        const at = Math.min(Math.max(share, 0), 1) * (STEPS.length - 1), step = Math.min(Math.floor(at), STEPS.length - 2);
        color.lerpColors(STEPS[step], STEPS[step + 1], at - step).toArray(out, 3 * i);
    });
    return out;
}

const VERTEX = `
    uniform float size;
    attribute vec3 tint;
    varying vec3 shown;
    void main() {
        vec4 place = modelViewMatrix * vec4(position, 1.0);
        bool isBehind = dot(normalize(normalMatrix * normal), -place.xyz) <= 0.0;
        shown = tint;
        gl_Position = isBehind ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * place;
        gl_PointSize = size * projectionMatrix[1][1] / max(-place.z, 1e-6);
    }`;
const FRAGMENT = `
    varying vec3 shown;
    void main() {
        gl_FragColor = vec4(shown, 1.0);
        #include <colorspace_fragment>
    }`;

/** shares: of the full error, one a point. */
export function errorPoints(positions, normals, shares) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setAttribute('normal', new BufferAttribute(normals, 3));
    geometry.setAttribute('tint', new BufferAttribute(errorColors(shares), 3));
    geometry.computeBoundingSphere();
    const width = geometry.boundingSphere.radius * WIDTH / Math.sqrt(shares.length);
    const material = new ShaderMaterial({ uniforms: { size: { value: 1 } }, vertexShader: VERTEX, fragmentShader: FRAGMENT });
    const points = new Points(geometry, material);
    points.onBeforeRender = (renderer) => { material.uniforms.size.value = width * renderer.domElement.height / 2; };
    return points;
}
