// SPDX-License-Identifier: MIT
// Does a browser show the pixels that OpenColorIO says, whichever viewer draws them, and does the command show the same?
//
//     node viewers.mjs [--keep FOLDER]     keeps assets and screenshots there
//
// HEMIBAKE: the command; HEMIBAKE_NODE_MODULES: the npm packages; HEMIBAKE_PYTHON: a Python with OpenColorIO's bindings; CHROMIUM:
// the browser. Exit status 77, skipped, without browser, packages or bindings, unless CI is set; 1 if a pixel is off.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { compareSmooth, compareTiles } from './pixels.mjs';
import { serve } from './server.mjs';

const HERE = dirname(fileURLToPath(import.meta.url)), ROOT = resolve(HERE, '../..');
const MODULES = process.env.HEMIBAKE_NODE_MODULES ?? join(ROOT, 'build/tests/node_modules');
const HEMIBAKE = resolve(process.env.HEMIBAKE ?? join(ROOT, 'build/release/bin/hemibake'));
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const PYTHON = process.env.HEMIBAKE_PYTHON ?? join(ROOT, 'build/tests/python/bin/python3'); // has OpenColorIO's bindings
const CONFIG = join(ROOT, 'color/hemibake.ocio');
const { OCIO, ...ENVIRONMENT } = process.env; // the tester's own configuration is none of the test's
const PAGE_PATIENCE_MS = 60000;

// power: encodes by the power 1 / 2.2 unless told otherwise; tonesUnlit: maps the tones of unlit materials too.
const VIEWERS = {
    three: { name: 'three.js', package: 'three', limit: 1, tonesUnlit: true },
    babylon: { name: 'Babylon.js', package: '@babylonjs/core', limit: 2, power: true, tonesUnlit: true },
    playcanvas: { name: 'PlayCanvas', package: 'playcanvas', limit: 2, power: true, tonesUnlit: true },
    'model-viewer': { name: '<model-viewer>', package: '@google/model-viewer', limit: 2 },
};

// ---- what is needed ----------------------------------------------------------------------------------------------------

function hasBindings() {
    try {
        execFileSync(PYTHON, ['-c', 'import PyOpenColorIO'], { stdio: 'ignore' });
        return true;
    } catch {
        return false;
    }
}

function missing() {
    if (!existsSync(CHROMIUM)) return 'there is no chromium';
    if (!existsSync(join(MODULES, 'playwright-core'))) return `the npm packages of tests/package.json are not in ${MODULES}`;
    if (!hasBindings()) return `${PYTHON} cannot import PyOpenColorIO`;
    if (!existsSync(HEMIBAKE)) return `there is no ${HEMIBAKE}`;
    return null;
}

const lacking = missing();
if (lacking) {
    console.log(`${process.env.CI ? 'failed' : 'skipped'}: ${lacking}; 'sh tests/browser/run.sh' installs what is needed`);
    process.exit(process.env.CI ? 1 : 77);
}

const require = createRequire(join(MODULES, 'index.js'));
const { PNG } = require('pngjs');
const keep = process.argv[2] === '--keep' ? resolve(process.argv[3]) : null;
const folder = keep ?? mkdtempSync(join(tmpdir(), 'hemibake-browser-'));
mkdirSync(folder, { recursive: true });

// ---- checks ------------------------------------------------------------------------------------------------------------

let checks = 0, failures = 0;

function check(label, good, detail) {
    checks++;
    if (!good) failures++;
    console.log(`${good ? 'ok    ' : 'FAILED'} ${label}: ${detail}`);
}

function checkTiles(label, picture, facts, expected, limit) {
    const { most, where } = compareTiles(picture, facts, expected);
    check(label, most <= limit, `at most ${most}/255 off over ${facts.centres.length} tiles${most > limit ? ` (${where})` : ''}`);
}

// A setting that is said to be needed must be: without it the pixels are wrong.
function checkWrong(label, picture, facts, expected) {
    const { most } = compareTiles(picture, facts, expected);
    check(label, most > 10, `${most}/255 off without the setting`);
}

// Less than half of the picture would prove little of it.
function checkSame(label, a, b) {
    const { most, where, covered } = compareSmooth(a, b);
    const percent = (100 * covered).toFixed(0);
    check(label, most <= 2 && covered > 0.5,
        `at most ${most}/255 apart over ${percent} % of the picture${most > 2 ? ` (${where})` : ''}`);
}

// ---- assets ------------------------------------------------------------------------------------------------------------

const toPixels = codes => codes.map(rgb => rgb.map(v => Math.round(255 * v)));
const readPicture = name => PNG.sync.read(readFileSync(join(folder, name)));
const toFolder = { cwd: folder, env: ENVIRONMENT, stdio: ['ignore', 'ignore', 'inherit'] };
const hemibake = (...words) => execFileSync(HEMIBAKE, words, toFolder);

function bake(scene, out, size, ...words) {
    hemibake('bake', `${scene}.glb`, '-o', `${out}.glb`, '--quality', 'draft', '--quiet', '--size', size,
        '--preview', `${out}.preview.png`, ...words);
    hemibake('render', `${out}.glb`, '-o', `${out}.render.png`, '--size', size);
}

function makeAssets() {
    execFileSync(PYTHON, ['-B', join(HERE, 'scenes.py'), folder, CONFIG], { stdio: 'inherit' });
    const facts = JSON.parse(readFileSync(join(folder, 'expected.json')));
    const size = `${facts.width}x${facts.height}`;
    facts.views.forEach((view, i) => {
        view.pixels = toPixels(view.codes);
        view.asset = `tiles${i}`;
        view.words = ['--display', view.display, '--view', view.view, '--exposure', `${facts.exposure_ev}`];
        bake('tiles', view.asset, size, ...view.words);
    });
    bake('mixed', 'mixed.baked', size, ...facts.views[1].words);
    bake('room', 'room.baked', size, '--view', 'Filmic');
    return facts;
}

async function bundle() {
    await require('esbuild').build({
        entryPoints: Object.keys(VIEWERS).map(name => join(HERE, 'pages', `${name}.mjs`)),
        bundle: true, splitting: true, format: 'esm',
        outdir: join(folder, 'bundles'), nodePaths: [MODULES], logLevel: 'error',
    });
}

// ---- the browser -------------------------------------------------------------------------------------------------------

const elsewhere = []; // what a page asked of another host

async function shoot(context, url, viewer, asset, setting = '') {
    const page = await context.newPage();
    const name = [viewer, asset, setting].filter(Boolean).join('.') + '.png';
    try {
        page.on('console', message => { if (message.type() === 'error') console.error(`${viewer}: ${message.text()}`); });
        page.on('request', request => {
            if (/^https?:/.test(request.url()) && !request.url().startsWith(url)) elsewhere.push(request.url());
        });
        await page.goto(`${url}/pages/index.html?${new URLSearchParams({ viewer, asset: `/assets/${asset}.glb`, setting })}`);
        await page.waitForFunction(() => window.drawn || window.failed, null, { timeout: PAGE_PATIENCE_MS });
        const failed = await page.evaluate(() => window.failed);
        if (failed) throw new Error(`${viewer}: ${failed}`);
        writeFileSync(join(folder, name), await page.screenshot());
        return readPicture(name);
    } finally {
        await page.close();
    }
}

// The power 1 / 2.2 for the curve of sRGB: what it does to each code value is known, and that is all it does.
function byPower(codes) {
    const decode = v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    return toPixels(codes.map(rgb => rgb.map(v => decode(v) ** (1 / 2.2))));
}

async function checkPower(shot, viewer, facts) {
    const { asset, codes, pixels } = facts.views[1], picture = await shot(viewer, asset, 'defaults');
    const { most } = compareTiles(picture, facts, pixels);
    check('encodes by the power 1 / 2.2 by default', most > 2 && most < 12, `${most}/255 off without the setting`);
    checkTiles('and that is all it does', picture, facts, byPower(codes), 1);
}

async function checkViewer(viewer, shot, facts) {
    const { name, limit, power, tonesUnlit, package: source } = VIEWERS[viewer];
    const { version } = JSON.parse(readFileSync(join(MODULES, source, 'package.json')));
    console.log(`\n${name} ${version}`);
    // A viewer is told codes, not views: where one takes all five, two say as much of the next.
    for (const view of viewer === 'three' ? facts.views : facts.views.slice(0, 2))
        checkTiles(`${view.display}, ${view.view}`, await shot(viewer, view.asset), facts, view.pixels, limit);
    const aces = facts.views[1];
    if (power) await checkPower(shot, viewer, facts);
    checkTiles('beside a lit material', await shot(viewer, 'mixed.baked'), facts, aces.pixels, limit);
    if (tonesUnlit) {
        checkWrong('tone mapping on', await shot(viewer, aces.asset, 'tone-mapped'), facts, aces.pixels);
        const spared = await shot(viewer, aces.asset, 'tone-mapped-off');
        checkTiles('tone mapping on, but not for baked materials', spared, facts, aces.pixels, limit);
    } else {
        checkTiles('tone mapping on', await shot(viewer, aces.asset, 'tone-mapped'), facts, aces.pixels, limit);
    }
    checkSame('a room, against hemibake render', await shot(viewer, 'room.baked'), readPicture('room.baked.render.png'));
}

function checkCommand(facts) {
    console.log('\nhemibake itself');
    for (const view of facts.views)
        for (const kind of ['render', 'preview'])
            checkTiles(`${kind}: ${view.display}, ${view.view}`, readPicture(`${view.asset}.${kind}.png`), facts, view.pixels, 2);
    checkSame('a room, preview against render', readPicture('room.baked.preview.png'), readPicture('room.baked.render.png'));
}

async function main() {
    const facts = makeAssets();
    await bundle();
    const draco = join(MODULES, 'three/examples/jsm/libs/draco/gltf');
    const server = await serve({ pages: join(HERE, 'pages'), bundles: join(folder, 'bundles'), assets: folder, draco });
    const browser = await require('playwright-core').chromium.launch({
        executablePath: CHROMIUM, headless: true,
        args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--force-color-profile=srgb',
            '--disable-dev-shm-usage'],
    });
    // One context for all pages, so that what they share is read and compiled once.
    const context = await browser.newContext({ viewport: { width: 640, height: 480 }, deviceScaleFactor: 1 });
    try {
        checkCommand(facts);
        for (const viewer of Object.keys(VIEWERS))
            await checkViewer(viewer, (...shot) => shoot(context, server.url, ...shot), facts);
        check('nothing came from another host', elsewhere.length === 0, elsewhere.join(' ') || 'all of it from 127.0.0.1');
    } finally {
        await browser.close();
        server.close();
        if (!keep) rmSync(folder, { recursive: true });
    }
    console.log(`\n${checks} checks, ${failures} failures`);
    return failures || !checks ? 1 : 0;
}

process.exitCode = await main();
