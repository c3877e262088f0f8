// The page without a server of ours: the folder that `./play --web` builds, with the engine as WebAssembly in a Worker.
// WEB names the folder.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, readdirSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';
import {gzipSync} from 'node:zlib';
import {at, beyond, bodies, carom, holding, paused, picture, place, root, screen, serveFolder, visit} from './harness.mjs';

const web = process.env.WEB ?? join(dirname(fileURLToPath(import.meta.url)), '../../../out/web');
const steps = Number(process.env.HASH_STEPS ?? 600);
const scratch = mkdtempSync(join(tmpdir(), 'carom-hashes-'));

let server;
before(async () => {
  assert.ok(existsSync(join(web, 'carom.wasm')), `${web} holds no built page: ./play --web makes one`);
  server = await serveFolder(web);
});
after(() => { server?.close(); rmSync(scratch, {recursive: true, force: true}); });

const packed = (name) => gzipSync(readFileSync(join(web, name)), {level: 9}).length;

/** The engine's files that a page waits for, as it asks for them: not those that are fetched in quiet. */
function engineFiles(page) {
  const asked = new Set();
  page.on('request', (request) => {
    const name = new URL(request.url()).pathname.slice(1);
    if (name === 'carom.wasm' || (name.endsWith('.wasm') && request.resourceType() === 'xhr')) asked.add(name);
  });
  return asked;
}

test('the page is small enough for a phone', () => {
  // What comes only when it is asked for: the editor, texts and sources of demos, each picture when it is scrolled to, and
  // the engine with its parts, which are counted below.
  const later = (name) => name.endsWith('.wasm') || ['sources.json', 'lessons.json', 'thumbnails'].includes(name) || name.startsWith('editor-');
  const page = readdirSync(web).filter((n) => !later(n)).reduce((sum, n) => sum + packed(n), 0);
  assert.ok(page <= 400e3, `the page takes ${page} bytes`);
  // All that the gallery has: nobody waits for it, but it is all fetched in the end.
  const engine = readdirSync(web).filter((n) => n.endsWith('.wasm')).reduce((sum, n) => sum + packed(n), 0);
  assert.ok(engine <= 1650e3, `the engine and its parts take ${engine} bytes`);
});

test('the first demo runs with the first file of the engine alone, at most 600 kB', async () => {
  const page = await visit('about:blank', {}, false), asked = engineFiles(page);
  await page.goto(`${server.url}#wrecking-ball`);
  await page.waitForFunction(() => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)?.[1]) > 200, null, {timeout: 120000});
  assert.deepEqual([...asked], ['carom.wasm']);
  assert.ok(packed('carom.wasm') <= 600e3, `the first file of the engine takes ${packed('carom.wasm')} bytes`);
  await page.done();
});

test('a part of the engine that is not there is named', async () => {
  const page = await visit('about:blank', {}, false);
  await page.route(/carom-[a-z-]+-[0-9a-f]{8}\.wasm$/, (route) => route.fulfill({status: 404}));
  await page.goto(`${server.url}#pool-table`);
  await page.waitForFunction(() => document.querySelector('#notice').textContent.includes('Reload the page'), null, {timeout: 60000});
  assert.match(page.problems.join(), /carom-.*wasm: the server answers 404/);
});

test('the engine runs in the page: grab, pause, step, a scene file', async () => {
  const page = await visit(`${server.url}#pyramids`);
  await beyond(page, 20);
  const top = await page.evaluate((all) => all.map((i) => [i, window.caromPage.viewer.bodyPosition(i)]).sort((a, b) => b[1][1] - a[1][1])[0][0], await bodies(page, 'dynamic'));
  const spot = await screen(page, top), before = await place(page, top);
  await page.mouse.move(spot.x, spot.y);
  await page.mouse.down();
  await holding(page);
  await page.mouse.move(spot.x, spot.y - 90, {steps: 10});
  await page.waitForFunction(([id, y]) => window.caromPage.viewer.bodyPosition(id)[1] > y + 0.3, [top, before[1]]);
  await picture(page, 'web');
  await page.mouse.up();
  const held = await paused(page);
  await page.click('#step');
  await at(page, held + 1);
  await page.evaluate(() => { location.hash = 'scene:newton_cradle'; });
  await page.waitForFunction(() => document.title.includes('radle'));
  await page.done();
});

/** In the page: state hashes of demos after so many steps, one after another, in one engine of its own. */
function hashesAfter(runs) {
  return new Promise((resolve, reject) => {
    const worker = new Worker('worker.js', {type: 'module'}), hashes = [];
    const send = (message) => worker.postMessage(JSON.stringify(message));
    let asked = 0, opened = false, demo, count;
    const next = () => {
      if (hashes.length === runs.length) { worker.terminate(); resolve(hashes); return; }
      [demo, count] = runs[hashes.length];
      asked = 0;
      opened = false;
      send({type: 'open', demo});
    };
    worker.onerror = (event) => reject(new Error(`${demo}: ${event.message}`));
    worker.onmessage = ({data}) => {
      if (typeof data === 'string') {
        const message = JSON.parse(data);
        if (message.type === 'error') reject(new Error(`${demo}: ${message.message}`));
        if (message.type === 'opened') { opened = true; send({type: 'pause'}); }
        // A status comes whenever a demo has something to say, also in the midst of the steps asked for.
        if (!opened || message.type !== 'status' || message.running || message.step < asked || message.step >= count) return;
        asked = Math.min(count, message.step + 100);
        send({type: 'step', count: asked - message.step});
        return;
      }
      const view = new DataView(data);
      if (view.getUint8(0) !== 2) return;
      send({type: 'ack', sequence: view.getUint32(4, true)});
      if (!opened || view.getUint32(8, true) < count || !(view.getUint8(1) & 2)) return;
      hashes.push(view.getBigUint64(view.byteLength - 16, true).toString(16).padStart(16, '0'));
      next();
    };
    send({type: 'hello', protocol: 1});
    next();
  });
}

test(`state hashes after ${steps} steps: native and WebAssembly in Chromium`, {timeout: 1800e3}, async () => {
  const run = promisify(execFile), limits = {maxBuffer: 1 << 26, cwd: root};
  const listed = JSON.parse((await run(carom, ['list', '--json'], limits)).stdout);
  const only = process.env.HASH_DEMOS?.split(',');
  const names = [...listed.demos.map((d) => d.demo), ...listed.scenes.map((d) => `scene:${d.demo}`), ...(only ? listed.stress.map((d) => d.demo) : [])]
    .filter((name) => !only || only.includes(name));
  // A page without a demo of its own: nothing else takes the processors.
  const page = await visit(`${server.url}worker.js`, {}, false);
  const nativeOf = async (some) => {
    const native = [];
    for (const name of some) {
      const {stdout} = await run(carom, ['run', name.replace(/^scene:/, ''), '--steps', String(steps), '--json', '--no-record', '--no-pictures', '--out', scratch], limits)
        .catch((error) => error);  // a failed expectation is not this test's matter
      native.push(JSON.parse(stdout));
    }
    return native;
  };
  const parts = Array.from({length: Math.ceil(names.length / 12)}, (_, i) => names.slice(12 * i, 12 * i + 12));
  let next = nativeOf(parts[0]);
  for (const [i, some] of parts.entries()) {
    const native = await next;
    if (i + 1 < parts.length) next = nativeOf(parts[i + 1]);  // while the page is at work
    const found = await page.evaluate(hashesAfter, some.map((name, k) => [name, native[k].steps]));
    some.forEach((name, k) => assert.equal(found[k], native[k].state_hash, name));
  }
});
