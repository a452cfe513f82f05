// SPDX-License-Identifier: MIT
// How soon has the page of a report drawn, and how much does the viewer show? The two figures that are asked of pages.
//
//     node figures.mjs [--runs N] [--keep FOLDER]     report: medians of N (5) openings; the folder keeps bakes and screenshots
//
// An output of at least 100,000 vertices is baked with --report, and its page opened from the disk, each time by a context that has
// cached nothing: milliseconds until it has loaded, its pictures are decoded and the frame with them has been shown, and what all
// processes of the browser took of processors in them; where that is less, it was the machine that was busy, and what is late is so by
// both. An output of at least 1,000,000 triangles is shown by `hemibake view`, on a desktop and a phone, light and dark: triangles as the
// page counts them, and as WebGL was told to draw in one frame. HEMIBAKE, HEMIBAKE_NODE_MODULES, CHROMIUM: as report.mjs has them.
// Minutes, and not a test: exit status 1 if a goal is missed, 77 if there is no browser.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { loadavg, tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

const ROOT = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const MODULES = process.env.HEMIBAKE_NODE_MODULES ?? join(ROOT, 'build/tests/node_modules');
const HEMIBAKE = resolve(process.env.HEMIBAKE ?? join(ROOT, 'build/release/bin/hemibake'));
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const ROOM = join(ROOT, 'samples/pillar-room.glb');
const PATIENCE = 300000;
const DESKTOP = { name: 'desktop', viewport: { width: 1280, height: 800 }, colorScheme: 'light' };
const SCREENS = [DESKTOP, { name: 'phone', viewport: { width: 390, height: 844 }, colorScheme: 'light' }, { ...DESKTOP, name: 'dark', colorScheme: 'dark' }];
// Elements of one size, none merged: as many triangles as there are.
const FINE = ['--quality', 'draft', '--merge-error', '0', '--patch-size', '0.5', '-q'];
const GOAL = { vertices: 100000, ms: 1000, triangles: 1000000 };

for (const [what, path] of [['chromium', CHROMIUM], ['playwright-core', join(MODULES, 'playwright-core')]]) {
    if (existsSync(path)) continue;
    console.log(`skipped: no ${what}`);
    process.exit(77);
}
const { chromium } = createRequire(join(MODULES, 'x.js'))('playwright-core');
const { values: asked } = parseArgs({ options: { runs: { type: 'string', default: '5' }, keep: { type: 'string' } } });
const folder = asked.keep ? resolve(asked.keep) : mkdtempSync(join(tmpdir(), 'hemibake-figures-'));
mkdirSync(folder, { recursive: true });

const median = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];
const count = (n) => n.toLocaleString('en');
let missed = 0;
function say(what, figure, goal, met) {
    if (!met) missed++;
    console.log(`${what}: ${figure}; goal ${goal}: ${met ? 'met' : 'MISSED'}; load ${loadavg()[0].toFixed(1)}`);
}

/** Bakes the room, and returns what its report says of the scene. */
function bake(out, ...options) {
    const json = `${out}.json`;
    execFileSync(HEMIBAKE, ['bake', ROOM, '-o', out, '--report', json, ...FINE, ...options], { stdio: ['ignore', 'ignore', 'inherit'] });
    return JSON.parse(readFileSync(json)).scene;
}

/* ---- the report ---- */

/** Milliseconds of processors that this process's children and theirs have taken so far. */
function processorMs() {
    const parents = new Map(), took = new Map(), tick = 10;
    for (const pid of readdirSync('/proc').filter((name) => /^\d+$/.test(name))) {
        try {
            const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ').map(Number);
            parents.set(Number(pid), fields[1]);
            took.set(Number(pid), tick * (fields[11] + fields[12]));
        } catch { /* it has just ended */ }
    }
    let sum = 0;
    for (const [pid, ms] of took) {
        let above = parents.get(pid);
        while (above > 1 && above !== process.pid) above = parents.get(above);
        if (above === process.pid) sum += ms;
    }
    return sum;
}

async function opened(browser, url) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, offline: true });
    const page = await context.newPage(), said = [];
    page.on('pageerror', (error) => said.push(String(error)));
    const before = processorMs(), began = performance.now();
    await page.goto(url);
    const inside = await page.evaluate(async () => {
        await Promise.all([...document.images].map((image) => image.decode()));
        await new Promise((shown) => requestAnimationFrame(() => requestAnimationFrame(shown)));
        return { ms: performance.now(), cards: document.querySelectorAll('section').length };
    });
    const outside = performance.now() - began, worked = processorMs() - before;
    await page.screenshot({ path: join(folder, 'report.png') });
    await context.close();
    if (said.length || inside.cards < 5) throw new Error(`the page is not whole: ${inside.cards} cards; ${said.join('; ')}`);
    return { ...inside, outside, worked };
}

async function measureReport(browser) {
    const html = join(folder, 'report.html'), out = join(folder, 'fine.glb');
    const options = ['--element-size', '0.024'];
    const { vertices_out: vertices } = bake(out, ...options);
    execFileSync(HEMIBAKE, ['bake', ROOM, '-o', out, '--report', html, ...FINE, ...options],
        { stdio: ['ignore', 'ignore', 'inherit'] });
    const times = [];
    for (let i = 0; i < Number(asked.runs); i++) times.push(await opened(browser, pathToFileURL(html).href));
    const outside = times.map((one) => one.outside), late = times.map((one) => Math.min(one.outside, one.worked));
    console.log(`report of ${count(vertices)} vertices, ${(statSync(html).size / 1e6).toFixed(2)} MB: drawn after ` +
        `${median(times.map((one) => one.ms)).toFixed(0)} ms by the page's own clock`);
    say('drawn, from the request on',
        `${median(outside).toFixed(0)} ms, at most ${Math.max(...outside).toFixed(0)} ms of ${outside.length}, ` +
        `${median(times.map((one) => one.worked)).toFixed(0)} ms of processors`,
        `${GOAL.ms} ms for ${count(GOAL.vertices)} vertices`, vertices >= GOAL.vertices && median(late) <= GOAL.ms);
}

/* ---- the viewer ---- */

/* Runs in the page before its own scripts: how many triangles the longest frame drew, and how long frames took. */
function countDrawn() {
    let now = 0;
    self.drawn = { triangles: 0, frames: 0 };
    for (const [name, at] of [['drawElements', 1], ['drawArrays', 2]]) {
        const own = WebGL2RenderingContext.prototype[name];
        WebGL2RenderingContext.prototype[name] = function draw(...given) {
            if (given[0] === this.TRIANGLES) now += given[at] / 3;
            return own.apply(this, given);
        };
    }
    const step = () => {
        if (now > 0) self.drawn.frames++;
        self.drawn.triangles = Math.max(self.drawn.triangles, now);
        now = 0;
        requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
}

async function look(browser, url, name, { viewport, colorScheme }) {
    const page = await (await browser.newContext({ viewport, colorScheme })).newPage(), said = [];
    page.on('pageerror', (error) => said.push(String(error)));
    page.on('console', (message) => message.type() === 'error' && said.push(message.text()));
    await page.addInitScript(countDrawn);
    const began = performance.now();
    await page.goto(url);
    await page.waitForSelector('body[data-ready]', { timeout: PATIENCE });
    const ready = await page.getAttribute('body', 'data-ready');
    if (ready !== 'yes') said.push(await page.textContent('#said'));
    const loaded = performance.now() - began;
    if (ready === 'yes')
        await page.waitForFunction(() => /frames a second/.test(document.getElementById('figures').textContent), null,
            { timeout: PATIENCE });
    const facts = await page.textContent('#figures'), { triangles, frames } = await page.evaluate(() => self.drawn);
    await page.screenshot({ path: join(folder, `${name}.png`), timeout: PATIENCE });
    await page.context().close();
    const counted = Number(/([\d,]+) triangles/.exec(facts)?.[1].replaceAll(',', '') ?? 0);
    const rate = /([\d.]+) frames a second/.exec(facts)?.[1] ?? '-';
    say(`viewer, ${name}`,
        `${count(counted)} triangles counted, ${count(triangles)} drawn in a frame, ${frames} frames, ${rate} a second, ` +
        `ready after ${(loaded / 1000).toFixed(1)} s, ${said.length ? `said: ${said.join('; ')}` : 'no error'}`,
        `${count(GOAL.triangles)} triangles`, counted >= GOAL.triangles && triangles >= GOAL.triangles && !said.length);
}

async function measureViewer(browser, screens, name, ...options) {
    const out = join(folder, `${name}.glb`);
    const { triangles_out: triangles } = bake(out, '--element-size', '0.0085', ...options);
    console.log(`${name}: ${count(triangles)} triangles by the report, ${(statSync(out).size / 1e6).toFixed(1)} MB`);
    const server = spawn(HEMIBAKE, ['view', out], { stdio: ['ignore', 'pipe', 'inherit'] });
    const [line] = await Promise.race([once(server.stdout, 'data'), once(server, 'exit').then(() => [null])]);
    if (line === null) throw new Error('the viewer did not start');
    try {
        for (const screen of screens) await look(browser, String(line).split(' ')[0], `${name}-${screen.name}`, screen);
    } finally {
        server.kill('SIGINT');
        await once(server, 'exit');
    }
}

const browser = await chromium.launch({
    executablePath: CHROMIUM, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
try {
    await measureReport(browser);
    await measureViewer(browser, SCREENS, 'plain', '--no-draco');
    await measureViewer(browser, [DESKTOP], 'draco');
    await measureViewer(browser, [DESKTOP], 'with-errors', '--vertex-errors', '--no-draco');
} finally {
    await browser.close();
    if (!asked.keep) rmSync(folder, { recursive: true });
}
process.exit(missed ? 1 : 0);
