// What the tests of the page share: a browser, `carom serve`, a plain static server, and questions to ask of a page.
// CAROM names the program, CHROMIUM the browser, PICTURES where screenshots go.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {existsSync, mkdirSync, readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {dirname, extname, join, normalize} from 'node:path';
import {after, afterEach} from 'node:test';
import {fileURLToPath} from 'node:url';
import {createRequire} from 'node:module';
import {chromium} from 'playwright-core';

const here = dirname(fileURLToPath(import.meta.url)), root = join(here, '../../..');
export {root};
export const carom = process.env.CAROM ?? join(here, '../../../build/release/apps/command/carom');
// The shell is the same browser without a window, which takes a tenth (demos.test) to a quarter (hands.test) less time.
const browserPath = process.env.CHROMIUM ?? ['chromium-headless-shell', 'chromium', 'google-chrome', 'chromium-browser'].map((name) => `/usr/bin/${name}`).find(existsSync);
export const pictures = process.env.PICTURES ?? join(here, '../../../out/page');
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
mkdirSync(pictures, {recursive: true});

/** Milliseconds until a condition counts as never coming true: machines differ by more than one expects. */
export const PATIENCE = 120e3;

/** The live server. */
export async function serve(port = 0) {
  const child = spawn(carom, ['serve', '--port', String(port)], {cwd: root, stdio: ['ignore', 'pipe', 'inherit']});
  const url = await new Promise((resolve, reject) => {
    let text = '';
    child.stdout.on('data', (bytes) => {
      text += bytes;
      const match = text.match(/http:\/\/[\w.:[\]]+\//);
      if (match) resolve(match[0]);
    });
    child.on('exit', (code) => reject(new Error(`carom serve ended with ${code}: ${text}`)));
    setTimeout(() => reject(new Error(`carom serve printed no address: ${text}`)), PATIENCE).unref();
  });
  // Its port is free once it has ended.
  const ended = new Promise((resolve) => child.on('exit', resolve));
  return {url, close: () => { child.kill('SIGINT'); return ended; }};
}

/** What a server says that wants its page isolated from others, so that it may share memory between threads. */
export const ISOLATED = {'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp'};

/** A folder over HTTP as the plainest web server would: no headers but the type, and that only of what browsers insist on, and those asked for. */
export async function serveFolder(folder, headers = {}) {
  const types = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml'};
  const server = createServer((request, response) => {
    const path = join(folder, normalize(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html'));
    if (!existsSync(path)) { response.writeHead(404).end(); return; }
    response.writeHead(200, {...headers, 'Content-Type': types[extname(path)] ?? 'application/octet-stream'}).end(readFileSync(path));
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close()};
}

const contexts = [];
let browser;
async function launched() {
  // WebGL is drawn by SwiftShader, the rest of the page without it: hands.test takes 62 s of processor time where the page
  // is put together as on a GPU, and 41 s where it is not.
  browser ??= await chromium.launch({executablePath: browserPath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader', '--disable-gpu-compositing', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync']});
  return browser;
}
afterEach(async () => {
  while (contexts.length > 0) await contexts.pop().close();
});
after(async () => { await browser?.close(); });

/**
 * In the page, before it: it draws the pictures that a test asks for, as finely as ever. Without a GPU the first one of a
 * page costs seconds of a processor (all shaders are compiled) and each one after it a good part of one, more than all else
 * together, and most tests ask for numbers. Otherwise the page goes through all that it does for a picture, twenty times a
 * second, but for having it drawn. demos.test draws every demo, load.mjs as many pictures as it can.
 */
function drawSparingly() {
  let made;
  Object.defineProperty(window, 'caromPage', {get: () => made, set: (page) => {
    made = page;
    const {viewer} = page, {renderer} = viewer, look = viewer.render.bind(viewer), draw = renderer.render.bind(renderer);
    let last = -Infinity, draws = true;  // what is drawn for a saved picture is drawn
    viewer.nextChange = Infinity;  // few pictures a second are this test's wish, not a slow machine's
    renderer.render = (...all) => { if (draws) { window.drawNow = false; draw(...all); } };
    viewer.render = (now) => {
      if (now - last < 50 && !window.drawNow) return;
      last = now;
      draws = window.drawNow;
      viewer.stale ||= draws;
      look(now);
      draws = true;
    };
  }});
}

/** A page at an address; `done` fails the test on any error that the page had. `sparing`: it draws only what a test looks at. */
export async function visit(address, {viewport = {width: 1000, height: 700}, sparing = true, ...options} = {}, shows = true) {
  const context = await (await launched()).newContext({viewport, ...options});
  contexts.push(context);
  if (sparing) await context.addInitScript(drawSparingly);
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => { if (message.type() === 'error') page.problems.push(message.text()); });
  // Nobody else is asked for anything.
  page.on('request', (request) => {
    const {protocol, origin} = new URL(request.url());
    if (protocol.startsWith('http') && address !== 'about:blank' && origin !== new URL(address).origin) page.problems.push(`a request to ${origin}`);
  });
  page.done = async () => assert.deepEqual(page.problems, []);
  await page.goto(address);
  if (shows) await page.waitForFunction(() => window.caromPage?.shown >= 0);
  return page;
}

export const stepOf = (page) => page.$eval('#clock', (e) => Number(e.textContent.match(/step (\d+)/)[1]));
/** The bodies of exactly this step are drawn; of one beyond it; the numbers of exactly this step are shown. */
export async function at(page, step) {
  try {
    await page.waitForFunction((n) => window.caromPage.shown === n && document.querySelector('#clock').textContent.endsWith(`step ${n}`), step);
  } catch (error) {
    const found = await page.evaluate(() => ({shown: window.caromPage.shown, past: document.querySelector('#past').max,
      ...Object.fromEntries(['clock', 'run', 'verdict', 'notice'].map((id) => [id, document.getElementById(id).textContent]))}));
    throw new Error(`step ${step} never came: ${JSON.stringify(found)}, problems: ${page.problems.join('; ') || 'none'}`, {cause: error});
  }
}
export const beyond = (page, step) => page.waitForFunction((n) => window.caromPage.shown > n, step);
export const hashAt = async (page, step) => {
  await page.waitForFunction((n) => document.querySelector('#numbers').dataset.step === String(n), step);
  return page.$$eval('#numbers dd', (all) => all[all.length - 1].textContent);
};
/** Runs on for so many steps, also where it starts anew meanwhile. */
export const runFor = async (page, steps) => page.waitForFunction(([seen, n]) => {
  const {shown} = window.caromPage;
  if (shown > seen.last) seen.sum += shown - seen.last;
  seen.last = shown;
  return seen.sum >= n;
}, [await page.evaluateHandle(() => ({last: window.caromPage.shown, sum: 0})), steps]);
/** Paused by its button; what has stopped by itself stays so. */
export const paused = async (page) => {
  await page.$eval('#run', (button) => { if (button.textContent === 'Pause') button.click(); });
  await until(page, 'Run');
  const step = await stepOf(page);
  await at(page, step);
  return step;
};
export const slide = (page, step) => page.$eval('#past', (slider, value) => { slider.value = value; slider.dispatchEvent(new Event('input')); }, step);
/** A body has moved from `before` by more than so many metres. */
export const movedFrom = (page, id, before, metres) => page.waitForFunction(([i, from, far]) => Math.hypot(...window.caromPage.viewer.bodyPosition(i).map((x, k) => x - from[k])) > far, [id, before, metres]);
/** A pointer holds a body. */
export const holding = (page) => page.waitForFunction(() => [...window.caromPage.hands.holds.values()].some((h) => h.held));
/** What has come is arranged for a picture, as it is twenty times a second. */
export const arranged = (page) => page.evaluate(() => new Promise((resolve) => { setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(resolve)), 60); }));
/** The picture of what has come is drawn. */
export const drawn = (page) => page.evaluate(() => new Promise((resolve) => {
  window.drawNow = true;
  requestAnimationFrame(() => requestAnimationFrame(resolve));
}));
export const until = (page, text) => page.waitForFunction((t) => document.querySelector('#run').textContent === t, text);
export const bodies = (page, type) => page.evaluate((t) => window.caromPage.viewer.bodyIds(t), type);
export const place = (page, id) => page.evaluate((i) => window.caromPage.viewer.bodyPosition(i), id);
export const screen = (page, id) => page.evaluate((i) => window.caromPage.viewer.screenOf(i), id);
export const demosOf = (page) => page.$$eval('#demo-list a', (links) => links.map((a) => a.dataset.demo));
export const picture = async (page, name) => {
  await drawn(page);
  await page.screenshot({path: join(pictures, `${name.replace(/\W/g, '_')}.png`)});
};
/** What a blind or keyboard user would stumble over, seriously, in a part of the page. */
export async function barriers(page, part) {
  if (!await page.evaluate(() => 'axe' in window)) await page.evaluate(axe);
  return page.evaluate(async (within) => (await window.axe.run(within ?? document, {resultTypes: ['violations']})).violations.filter((v) => ['serious', 'critical'].includes(v.impact))
    .map((v) => `${v.id}: ${v.nodes.map((n) => n.target).join(' ')}`), part);
}
