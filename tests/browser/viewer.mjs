// SPDX-License-Identifier: MIT
// Does `hemibake view` show a bake: on a desktop and a phone, light and dark, every mode, and from this machine alone?
//
//     node viewer.mjs [--keep FOLDER]     keeps screenshots there
//
// HEMIBAKE: the command; HEMIBAKE_NODE_MODULES: the npm packages; CHROMIUM: the browser. Exit status 77, skipped, without them, unless
// CI is set; 1 if something is wrong.
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { request } from 'node:http';
import { createRequire } from 'node:module';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const ROOT = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const MODULES = process.env.HEMIBAKE_NODE_MODULES ?? join(ROOT, 'build/tests/node_modules');
const HEMIBAKE = resolve(process.env.HEMIBAKE ?? join(ROOT, 'build/release/bin/hemibake'));
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
// A busy machine draws a frame in software in seconds.
const PATIENCE = 120000;
const MODES = ['original', 'baked', 'wires', 'error'];
const SCREENS = [
    { name: 'desktop', width: 1280, height: 800, colorScheme: 'light' },
    { name: 'phone', width: 390, height: 844, colorScheme: 'light' },
    { name: 'dark', width: 1280, height: 800, colorScheme: 'dark' },
];

for (const [what, path] of [['chromium', CHROMIUM], ['three', join(MODULES, 'three')], ['playwright-core', join(MODULES, 'playwright-core')]]) {
    if (existsSync(path)) continue;
    console.log(`skipped: no ${what}`);
    process.exit(process.env.CI ? 1 : 77);
}
const { PNG } = createRequire(join(MODULES, 'x.js'))('pngjs');
const { chromium } = createRequire(join(MODULES, 'x.js'))('playwright-core');

let failures = 0;
function check(name, ok, detail = '') {
    if (!ok) failures++;
    console.log(`${ok ? 'ok' : 'not ok'} - ${name}${ok ? '' : `: ${detail}`}`);
}

/* Of the middle of a picture: how many colours there are, and how light they are on average. */
function middle(bytes) {
    const { width, height, data } = PNG.sync.read(bytes), seen = new Set();
    let sum = 0, count = 0;
    for (let y = Math.floor(height / 3); y < 2 * height / 3; y++)
        for (let x = Math.floor(width / 4); x < 3 * width / 4; x++) {
            const i = 4 * (y * width + x);
            seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
            sum += data[i] + data[i + 1] + data[i + 2], count += 3;
        }
    return { colours: seen.size, light: sum / count };
}

async function look(browser, url, screen, folder) {
    const { name, width, height, colorScheme } = screen;
    const context = await browser.newContext({ viewport: { width, height }, colorScheme });
    const page = await context.newPage(), said = [], asked = [];
    page.on('pageerror', (error) => said.push(String(error)));
    page.on('console', (message) => message.type() === 'error' && said.push(message.text()));
    page.on('request', (one) => asked.push(one.url()));
    await page.goto(url);
    await page.waitForSelector('body[data-ready]', { timeout: PATIENCE });
    check(`${name}: it is ready`, (await page.getAttribute('body', 'data-ready')) === 'yes', await page.textContent('#said'));
    check(`${name}: it begins with the bake`, (await page.getAttribute('body', 'data-mode')) === 'baked');
    const pictures = {};
    for (const mode of MODES) {
        check(`${name}: ${mode} can be had`, await page.isEnabled(`button[data-mode=${mode}]`));
        await page.evaluate((one) => document.querySelector(`button[data-mode=${one}]`).click(), mode);
        // The frame rate is said once frames have been drawn, however slow software is at it.
        if (mode !== 'error') await page.waitForFunction(() => /frames a second/.test(document.getElementById('figures').textContent), null, { timeout: PATIENCE });
        await page.waitForTimeout(300);
        const shot = await page.screenshot({ path: join(folder, `${name}-${mode}.png`) });
        pictures[mode] = middle(shot);
        check(`${name}: ${mode} is drawn`, pictures[mode].colours > 4, JSON.stringify(pictures[mode]));
    }
    check(`${name}: modes look different`, new Set(Object.values(pictures).map((one) => one.light.toFixed(1))).size === MODES.length, JSON.stringify(pictures));
    await page.keyboard.press('2');
    await page.waitForFunction(() => /frames a second/.test(document.getElementById('figures').textContent), null, { timeout: PATIENCE });
    const facts = await page.textContent('#facts');
    check(`${name}: bytes and triangles are said`, /room\.glb.*kB.*triangles.*vertices/.test(facts), facts);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    check(`${name}: nothing is wider than the screen`, wide <= width, wide);
    check(`${name}: nothing is asked of anybody else`, asked.every((one) => one.startsWith(url) || /^(data|blob):/.test(one)), asked.join(' '));
    check(`${name}: no error is said`, said.length === 0, said.join('; '));
    await context.close();
}

/* The status of an answer to a request as it stands. */
const status = (port, path, host) => new Promise((resolve, reject) => {
    request({ host: '127.0.0.1', port, path, headers: { Host: host ?? `127.0.0.1:${port}` } }, (answer) => {
        answer.resume();
        resolve(answer.statusCode);
    }).on('error', reject).end();
});

async function checkServer(port) {
    connect(port, '127.0.0.1').on('error', () => {}); // stays idle, as browsers have them
    check('what is idle is in nobody\'s way', (await status(port, '/config.json')) === 200);
    check('a name that means this machine elsewhere is refused', (await status(port, '/config.json', 'example.org')) === 403);
    for (const path of ['/../room.in.glb', '/out/../../etc/passwd', '/out/%2e%2e/%2e%2e/etc/passwd', '/nowhere.js', '//etc/passwd', '/out/%zz'])
        check(`${path} is refused`, [400, 404].includes(await status(port, path)));
}

const kept = process.argv[2] === '--keep' ? resolve(process.argv[3]) : null;
const folder = kept ?? mkdtempSync(join(tmpdir(), 'hemibake view '));
mkdirSync(folder, { recursive: true });
execFileSync('sh', [join(ROOT, 'samples/web-viewer/build.sh'), join(dirname(HEMIBAKE), '../share/hemibake/viewer')], { stdio: 'inherit' });
const room = join(ROOT, 'samples/pillar-room.glb');
for (const [name, seed] of [['room.glb', '1'], ['other.glb', '2']])
    execFileSync(HEMIBAKE, ['bake', room, '-o', join(folder, name), '--quality', 'draft', '--scene-linear', '--seed', seed, '--vertex-errors', '-q'], { stdio: 'ignore' });
async function serve(...options) {
    const server = spawn(HEMIBAKE, ['view', join(folder, 'room.glb'), ...options], { stdio: ['ignore', 'pipe', 'inherit'] });
    const [line] = await once(server.stdout, 'data');
    const [url, port] = String(line).match(/^http:\/\/127\.0\.0\.1:(\d+)\//);
    return { server, url, port };
}

/* Without anything to compare with, a bake with _ERROR says itself where it is off. */
async function checkEstimates(browser) {
    const { server, url } = await serve();
    const page = await (await browser.newContext({ viewport: SCREENS[0] })).newPage();
    await page.goto(url);
    await page.waitForSelector('body[data-ready]', { timeout: PATIENCE });
    check('where a bake says that it is off can be had', await page.isEnabled('button[data-mode=error]'));
    await page.evaluate(() => document.querySelector('button[data-mode=error]').click());
    await page.waitForTimeout(1000);
    const shown = middle(await page.screenshot({ path: join(folder, 'estimates.png') }));
    check('where a bake says that it is off is drawn', shown.colours > 50, JSON.stringify(shown));
    check('the scale says how far', /\d % and more/.test(await page.textContent('#full')));
    server.kill('SIGINT');
    await once(server, 'exit');
}

const { server, url, port } = await serve('--before', room, '--reference', join(folder, 'other.glb'));
const browser = await chromium.launch({ executablePath: CHROMIUM, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
try {
    await checkServer(Number(port));
    await checkEstimates(browser);
    for (const screen of SCREENS) await look(browser, url, screen, folder);
} finally {
    await browser.close();
    server.kill('SIGINT');
}
await once(server, 'exit');
if (!kept) rmSync(folder, { recursive: true });
process.exit(failures ? 1 : 0);
