// SPDX-License-Identifier: MIT
// What do the gallery, a report and the viewer look like? Takes the pictures of samples/gallery anew.
//
//     sh samples/gallery.sh && node tests/browser/pictures.mjs [FOLDER OF gallery.sh]     default: build/gallery
//
// HEMIBAKE, HEMIBAKE_NODE_MODULES, CHROMIUM: as in viewer.mjs. Not a test: pictures are to be looked at.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { copyFileSync, mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const ROOT = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const MODULES = process.env.HEMIBAKE_NODE_MODULES ?? join(ROOT, 'build/tests/node_modules');
const HEMIBAKE = resolve(process.env.HEMIBAKE ?? join(ROOT, 'build/release/bin/hemibake'));
const GALLERY = resolve(process.argv[2] ?? join(ROOT, 'build/gallery')), OUT = join(ROOT, 'samples/gallery');
const PATIENCE = 300000; // of software that draws a living room
const { chromium } = createRequire(join(MODULES, 'x.js'))('playwright-core');
const SCREENS = [
    { name: 'desktop', width: 1280, height: 800, colorScheme: 'light' },
    { name: 'phone', width: 390, height: 844, colorScheme: 'light' },
    { name: 'dark', width: 1280, height: 800, colorScheme: 'dark' },
];

/** Small, by the browser's own filter, which keeps what plots draw as sharp as text. */
async function shrink(browser, png, width, path) {
    const page = await browser.newPage({ viewport: { width, height: 100 } });
    await page.setContent(`<body style="margin:0"><img style="display:block;width:${width}px" src="data:image/png;base64,${png.toString('base64')}">`);
    await page.waitForFunction(() => document.images[0].complete);
    await page.locator('img').screenshot({ path, type: 'jpeg', quality: 80 });
    await page.close();
}

async function take(browser, url, { width, height, colorScheme = 'light' }, scale, name, ready) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme });
    const page = await context.newPage(), path = join(OUT, `${name}.jpg`);
    await page.goto(url);
    await ready(page);
    await shrink(browser, await page.screenshot({ fullPage: true, timeout: PATIENCE }), Math.round(scale * width), path);
    await context.close();
    console.log(path);
}

/** The pictures of the page are loaded as they are scrolled to. */
async function scroll(page) {
    await page.evaluate(() => { for (const image of document.images) image.loading = 'eager'; });
    await page.waitForFunction(() => [...document.images].every((image) => image.complete && image.naturalWidth > 0));
}

/** A frame rate is said once frames have been drawn. */
async function drawn(page) {
    await page.waitForSelector('body[data-ready=yes]', { timeout: PATIENCE });
    await page.waitForFunction(() => /frames a second/.test(document.getElementById('figures').textContent), null, { timeout: PATIENCE });
}

const folder = mkdtempSync(join(tmpdir(), 'hemibake-pictures-')), report = join(folder, 'pillar-room.html');
execFileSync('sh', [join(ROOT, 'samples/web-viewer/build.sh'), join(dirname(HEMIBAKE), '../share/hemibake/viewer')], { stdio: 'ignore' });
copyFileSync(join(ROOT, 'samples/pillar-room.glb'), join(folder, 'pillar-room.glb'));
execFileSync(HEMIBAKE, ['bake', 'pillar-room.glb', '-o', 'pillar-room.baked.glb', '--report', 'pillar-room.html'], { cwd: folder, stdio: 'ignore' });
const server = spawn(HEMIBAKE, ['view', join(GALLERY, 'interior.glb'), '--before', join(GALLERY, 'interior.in.glb')], { stdio: ['ignore', 'pipe', 'inherit'] });
const [line] = await once(server.stdout, 'data'), [view] = String(line).match(/^http:\/\/127\.0\.0\.1:\d+\//);
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
try {
    await take(browser, pathToFileURL(join(GALLERY, 'index.html')).href, { width: 1120, height: 800 }, 0.8, 'page', scroll);
    for (const screen of SCREENS) await take(browser, pathToFileURL(report).href, { ...screen, width: Math.min(screen.width, 960) }, 0.6, `report-${screen.name}`, scroll);
    for (const screen of SCREENS) await take(browser, view, screen, 1, `view-${screen.name}`, drawn);
} finally {
    await browser.close();
    server.kill('SIGINT');
    rmSync(folder, { recursive: true });
}
