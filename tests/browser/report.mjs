// SPDX-License-Identifier: MIT
// Does the page of --report out.html open offline, on a desktop and a phone, light and dark, and does its slider move?
//
//     node report.mjs [--keep FOLDER]     keeps the page and screenshots there
//
// HEMIBAKE: the command; HEMIBAKE_NODE_MODULES: the npm packages; CHROMIUM: the browser. Exit status 77, skipped, without them, unless
// CI is set; 1 if something is wrong.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const ROOT = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const MODULES = process.env.HEMIBAKE_NODE_MODULES ?? join(ROOT, 'build/tests/node_modules');
const HEMIBAKE = resolve(process.env.HEMIBAKE ?? join(ROOT, 'build/release/bin/hemibake'));
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const SCREENS = [
    { name: 'desktop', width: 1280, height: 900, colorScheme: 'light', dark: false },
    { name: 'phone', width: 390, height: 844, colorScheme: 'light', dark: false },
    { name: 'dark', width: 1280, height: 900, colorScheme: 'dark', dark: true },
];
const CARDS = ['Before and after', 'Warnings', 'Error', 'Estimated error against time', 'Where time went', 'Energy, watts', 'Sizes of triangles', 'Scene',
    'Colour', 'Options', 'All of the report'];

for (const [what, path] of [['chromium', CHROMIUM], ['playwright-core', join(MODULES, 'playwright-core')]]) {
    if (existsSync(path)) continue;
    console.log(`skipped: no ${what}`);
    process.exit(process.env.CI ? 1 : 77);
}

let failures = 0;
function check(name, ok, detail = '') {
    if (!ok) failures++;
    console.log(`${ok ? 'ok' : 'not ok'} - ${name}${ok ? '' : `: ${detail}`}`);
}

/** Brightness of the page's ground, 0..1. */
const ground = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).reduce((sum, x) => sum + Number(x), 0) / 765);

/** Runs in the page: of each plot, how many pixels of its canvas have the colour of what is plotted. */
function plotted() {
    const probe = document.createElement('canvas').getContext('2d');
    probe.fillStyle = getComputedStyle(document.body).getPropertyValue('--a');
    probe.fillRect(0, 0, 1, 1);
    const wanted = probe.getImageData(0, 0, 1, 1).data;
    return [...document.querySelectorAll('.plot canvas')].map((canvas) => {
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        let count = 0;
        for (let i = 0; i < data.length; i += 4) count += [0, 1, 2].every((k) => Math.abs(data[i + k] - wanted[k]) < 12) && data[i + 3] > 200;
        return count;
    });
}

async function lookAtPlots(page, name) {
    const drawn = await page.evaluate(plotted);
    check(`${name}: both plots are drawn, in the page's colours`, drawn.length === 2 && drawn.every((count) => count > 100), drawn);
    await page.locator('.plot .u-over').first().hover();
    const said = await page.locator('.plot .u-legend').first().textContent();
    check(`${name}: a plot says its values under the pointer`, /seconds:?\s*[\d.]+error:?\s*[\d.]+ %/.test(said), said);
}

/** A program that was built without npm writes pages without the library. */
async function lookWithoutPlots(browser, file) {
    const page = await (await browser.newContext({ offline: true })).newPage(), said = [];
    page.on('pageerror', (error) => said.push(String(error)));
    const bare = readFileSync(file, 'utf8').replace(/<!-- uPlot[^]*?<\/script>/, '');
    writeFileSync(`${file}.bare.html`, bare);
    await page.goto(pathToFileURL(`${file}.bare.html`).href);
    const rows = await page.locator('section', { hasText: 'Sizes of triangles' }).locator('tr').count();
    check('without the library its numbers stand in tables', rows > 1 && said.length === 0, `${rows} rows; ${said.join('; ')}`);
    await page.context().close();
}

async function look(browser, file, screen, folder) {
    const { name, width, height, colorScheme, dark } = screen;
    const context = await browser.newContext({ viewport: { width, height }, colorScheme, offline: true });
    const page = await context.newPage();
    const said = [];
    page.on('pageerror', (error) => said.push(String(error)));
    page.on('console', (message) => said.push(message.text()));
    await page.goto(pathToFileURL(file).href);
    const cards = await page.locator('section h2').allTextContents();
    check(`${name}: every card is there`, CARDS.every((card) => cards.includes(card)), cards.join(', '));
    const images = await page.evaluate(() => [...document.images].map((image) => image.naturalWidth));
    check(`${name}: the three pictures are shown`, images.length === 3 && images.every((wide) => wide === 960), images);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    check(`${name}: nothing is wider than the screen`, wide <= width, wide);
    const before = await page.locator('.slider .over').evaluate((over) => over.style.clipPath);
    await page.locator('input[type=range]').fill('80');
    const after = await page.locator('.slider .over').evaluate((over) => over.style.clipPath);
    check(`${name}: the slider moves`, before !== after && after.includes('20%'), after);
    await lookAtPlots(page, name);
    const light = await ground(page);
    check(`${name}: the ground is ${dark ? 'dark' : 'light'}`, dark ? light < 0.2 : light > 0.8, light);
    await page.screenshot({ path: join(folder, `${name}.png`), fullPage: true });
    check(`${name}: no error is said`, said.length === 0, said.join('; '));
    await context.close();
}

const kept = process.argv[2] === '--keep' ? resolve(process.argv[3]) : null;
const folder = kept ?? mkdtempSync(join(tmpdir(), 'hemibake-report-'));
mkdirSync(folder, { recursive: true });
const file = join(folder, 'report.html');
execFileSync(HEMIBAKE, ['bake', join(ROOT, 'samples/pillar-room.glb'), '-o', join(folder, 'room.glb'), '--quality', 'draft', '--report', file, '-q']);
check('the page is at most 2 MB', statSync(file).size <= 2e6, statSync(file).size);
check('the licence of the library of its plots is in it', /Copyright \(c\) \d+ Leon Sorokin/.test(readFileSync(file, 'utf8')));
const { chromium } = createRequire(join(MODULES, 'x.js'))('playwright-core');
const browser = await chromium.launch({ executablePath: CHROMIUM, args: ['--no-sandbox'] });
for (const screen of SCREENS) await look(browser, file, screen, folder);
await lookWithoutPlots(browser, file);
await browser.close();
if (!kept) rmSync(folder, { recursive: true });
process.exit(failures ? 1 : 0);
