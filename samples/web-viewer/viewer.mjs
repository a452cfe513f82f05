// SPDX-License-Identifier: MIT
// What does the page show? A baked asset beside the one that it was made of, its wires, and where it is off. What to load comes
// from config.json, which `hemibake view` serves, or from the address: ?out=URL&before=URL&error=URL.
import {
    Box3, BufferAttribute, Color, DirectionalLight, HemisphereLight, MeshBasicMaterial, NoToneMapping, PerspectiveCamera, Scene, SRGBColorSpace, Vector3,
    WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { errorColors, errorPoints, SCALE } from './error-scale.mjs';

const MODES = [
    { name: 'original', label: 'Original', lacks: 'the asset that was baked is not there: hemibake view OUT --before IN' },
    { name: 'baked', label: 'Baked', lacks: 'nothing is loaded' },
    { name: 'wires', label: 'Wireframe', lacks: 'nothing is loaded' },
    { name: 'error', label: 'Error', lacks: 'there is nothing to compare with: bake with --vertex-errors, or hemibake view OUT --reference PROBES.hprb or another bake' },
];
// It is drawn for so long after anything has changed, ms, and the frame rate is the mean over as many frames at least.
const AWAKE = 1500, FRAMES = 5;

const element = (id) => document.getElementById(id);
const renderer = new WebGLRenderer({ antialias: true });
renderer.toneMapping = NoToneMapping; // the light in the vertices has been through a view transform
document.body.prepend(renderer.domElement);
const camera = new PerspectiveCamera(50, 1, 0.01, 1000);
const controls = new OrbitControls(camera, renderer.domElement);
const draco = new DRACOLoader().setDecoderPath('draco/');
const loader = new GLTFLoader().setDRACOLoader(draco);
const scenes = {}; // by mode: what is drawn
const facts = {};  // by mode: what is said of it
let mode = null, framed = false;

/* ---- what is said ---- */

function say(text) {
    element('said').textContent = text;
    element('said').hidden = !text;
}

const bytes = (n) => (n < 1e6 ? `${(n / 1e3).toFixed(1)} kB` : `${(n / 1e6).toFixed(2)} MB`);

function figures(root, size) {
    let triangles = 0, vertices = 0;
    root.traverse((node) => {
        if (!node.isMesh) return;
        const { index, attributes } = node.geometry, copies = node.isInstancedMesh ? node.count : 1;
        triangles += copies * (index ? index.count : attributes.position.count) / 3;
        vertices += attributes.position.count;
    });
    return [bytes(size), `${triangles.toLocaleString('en')} triangles`, `${vertices.toLocaleString('en')} vertices`];
}

function showFacts(rate) {
    const found = facts[mode];
    element('facts').hidden = !found;
    if (!found) return;
    element('name').textContent = found.name;
    element('figures').replaceChildren(...[...found.figures, rate].filter(Boolean).map((text) => Object.assign(document.createElement('span'), { textContent: text })));
}

/* ---- modes ---- */

function background() {
    const color = getComputedStyle(document.body).backgroundColor;
    return new Color().setStyle(color, SRGBColorSpace);
}

function show(name) {
    if (!scenes[name]) return;
    mode = name;
    for (const button of element('modes').children) button.setAttribute('aria-pressed', String(button.dataset.mode === name));
    element('scale').hidden = name !== 'error';
    document.body.dataset.mode = name;
    showFacts('');
    wake();
}

function updateButtons() {
    for (const button of element('modes').children) {
        const { name, lacks } = MODES.find((one) => one.name === button.dataset.mode);
        button.disabled = !scenes[name];
        button.title = scenes[name] ? '' : lacks;
    }
}

for (const [i, { name, label }] of MODES.entries()) {
    const button = Object.assign(document.createElement('button'), { type: 'button', textContent: label });
    button.dataset.mode = name;
    button.addEventListener('click', () => show(name));
    element('modes').append(button);
    addEventListener('keydown', (event) => event.key === String(i + 1) && show(name));
}
updateButtons();

/* ---- loading ---- */

/* From the asset's first camera, else from outside. */
function frame(root, cameras) {
    const box = new Box3().setFromObject(root), size = box.getSize(new Vector3()).length() || 1, middle = box.getCenter(new Vector3());
    camera.near = size / 2000;
    camera.far = size * 20;
    if (cameras.length && cameras[0].isPerspectiveCamera) {
        root.updateMatrixWorld(true);
        cameras[0].getWorldPosition(camera.position);
        const ahead = cameras[0].getWorldDirection(new Vector3());
        const distance = Math.max(middle.clone().sub(camera.position).dot(ahead), size / 10);
        controls.target.copy(camera.position).addScaledVector(ahead, distance);
        camera.fov = cameras[0].fov;
    } else {
        controls.target.copy(middle);
        camera.position.copy(middle).add(new Vector3(0.55, 0.35, 0.85).multiplyScalar(size / Math.min(innerWidth / innerHeight, 1)));
    }
    camera.updateProjectionMatrix();
    controls.update();
    wake();
    framed = true;
}

function sceneOf(root) {
    const scene = new Scene();
    scene.add(root);
    return scene;
}

/* The same meshes over again, drawn otherwise. */
function copyWith(root, material) {
    const copy = root.clone();
    copy.traverse((node) => { if (node.isMesh) node.material = material; });
    return copy;
}

function addBaked(gltf, found) {
    gltf.scene.traverse((node) => { if (node.isMesh) node.material.toneMapped = false; });
    scenes.baked = sceneOf(gltf.scene);
    facts.baked = facts.wires = found;
    scenes.wires = sceneOf(copyWith(gltf.scene, new MeshBasicMaterial({ wireframe: true, color: 0x2a7fc9 })));
    addEstimates(gltf.scene);
    frame(gltf.scene, gltf.cameras);
}

/* Lit as editors light what has no light of its own. */
function addOriginal(gltf, found) {
    scenes.original = sceneOf(gltf.scene);
    const lamp = new DirectionalLight(0xffffff, 1.5);
    lamp.position.set(0.4, 0.8, 0.5);
    scenes.original.add(new HemisphereLight(0xffffff, 0x8a8478, 2), lamp);
    facts.original = found;
    if (!framed) frame(gltf.scene, gltf.cameras);
}

/* What a bake itself says of where it is off (--vertex-errors), until something to compare with says better. */
function addEstimates(root) {
    const lists = [];
    root.traverse((node) => { if (node.isMesh && node.geometry.attributes._error) lists.push(node.geometry.attributes._error.array); });
    const found = new Float32Array(lists.reduce((count, list) => count + list.length, 0));
    let filled = 0;
    for (const list of lists) {
        found.set(list, filled);
        filled += list.length;
    }
    if (!found.length) return;
    found.sort();
    const full = found[Math.floor(0.95 * (found.length - 1))] || 1;
    const copy = copyWith(root, new MeshBasicMaterial({ vertexColors: true }));
    copy.traverse((node) => {
        const shares = node.isMesh ? node.geometry.attributes._error : null;
        if (!shares) return;
        node.geometry = node.geometry.clone();
        node.geometry.setAttribute('color', new BufferAttribute(errorColors(Array.from(shares.array, (one) => one / full)), 3));
    });
    scenes.error = sceneOf(copy);
    facts.error = { name: facts.baked.name, figures: ['where its own estimate lies'] };
    showScale(full);
}

function showScale(full) {
    element('full').textContent = `${(100 * full).toFixed(2)} % and more`;
    document.querySelector('#scale i').style.background = `linear-gradient(90deg, ${SCALE.join(', ')})`;
}

/* Rows of float32: place, normal, error as a share; ahead of them the share that is drawn lightest. */
function addErrors(buffer) {
    const values = new Float32Array(buffer), full = values[0], count = Math.floor((values.length - 1) / 7);
    const positions = new Float32Array(3 * count), normals = new Float32Array(3 * count), shares = new Float32Array(count);
    for (let i = 0; i < count; i++) {
        positions.set(values.subarray(1 + 7 * i, 4 + 7 * i), 3 * i);
        normals.set(values.subarray(4 + 7 * i, 7 + 7 * i), 3 * i);
        shares[i] = full > 0 ? values[7 + 7 * i] / full : 0;
    }
    const hider = new MeshBasicMaterial({ color: 0x202226, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4 });
    scenes.error = sceneOf(copyWith(scenes.baked.children[0], hider));
    scenes.error.add(errorPoints(positions, normals, shares));
    facts.error = { name: facts.baked.name, figures: [`${count.toLocaleString('en')} points compared`] };
    showScale(full);
}

async function fetched(url) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    return response.arrayBuffer();
}

async function load(buffer, url, add) {
    const gltf = await loader.parseAsync(buffer, url.slice(0, url.lastIndexOf('/') + 1));
    const name = decodeURIComponent(url.slice(url.lastIndexOf('/') + 1));
    add(gltf, { name, figures: figures(gltf.scene, buffer.byteLength) });
    updateButtons();
}

async function loadAll({ out, before, error }) {
    say(out ? `Loading ${out} …` : '');
    if (out) await load(await fetched(out), out, addBaked);
    if (out) show('baked');
    say('');
    if (before) await load(await fetched(before), before, addOriginal);
    if (error) addErrors(await fetched(error));
    updateButtons();
}

async function asked() {
    const query = new URLSearchParams(location.search);
    if (query.has('out')) return Object.fromEntries(query);
    const response = await fetch('config.json').catch(() => null);
    return response?.ok ? response.json() : {};
}

/* What is dropped is the baked asset if a bake has stamped it, else the original. */
async function take(file) {
    const buffer = await file.arrayBuffer();
    const text = new TextDecoder().decode(buffer.slice(0, Math.min(buffer.byteLength, 1 << 22)));
    const baked = text.includes('"hemibake"') && text.includes('KHR_materials_unlit');
    say('');
    await load(buffer, file.name, baked ? addBaked : addOriginal);
    show(baked ? 'baked' : 'original');
}

addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => {
    event.preventDefault();
    for (const file of event.dataTransfer.files) take(file).catch((error) => say(`${file.name}: ${error.message}`));
});

/* ---- drawing ---- */

function fit() {
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(innerWidth, innerHeight, false);
    camera.aspect = innerWidth / innerHeight;
    camera.updateProjectionMatrix();
}

/* Draws while anything moves; a page that nobody touches takes no power. */
let until = 0, began = 0, frames = 0;
function wake() {
    const now = performance.now();
    if (now > until) began = now, frames = 0;
    until = now + AWAKE;
}

renderer.setAnimationLoop(() => {
    controls.update();
    const now = performance.now();
    if (!mode || (now > until && frames >= FRAMES)) return;
    scenes[mode].background = background();
    renderer.render(scenes[mode], camera);
    if (++frames < FRAMES || now - began < AWAKE / 2) return;
    const rate = 1000 * frames / (now - began);
    showFacts(`${rate.toFixed(rate < 10 ? 1 : 0)} frames a second`);
});
controls.addEventListener('change', wake);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', wake);
addEventListener('resize', () => { fit(); wake(); });
fit();
asked().then((config) => (config.out ? loadAll(config) : null)).then(() => { document.body.dataset.ready = 'yes'; })
    .catch((error) => { say(error.message); document.body.dataset.ready = 'failed'; });
