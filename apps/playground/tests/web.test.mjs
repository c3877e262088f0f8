// The page without a server of ours: the folder that `./play --web` builds, with the engine as WebAssembly in a Worker.
// WEB names the folder.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {existsSync, readFileSync, readdirSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';
import {gzipSync} from 'node:zlib';
import {bodies, carom, picture, place, screen, serveFolder, stepOf, until, visit} from './harness.mjs';

const web = process.env.WEB ?? join(dirname(fileURLToPath(import.meta.url)), '../../../out/web');
const steps = Number(process.env.HASH_STEPS ?? 600);

let server;
before(async () => {
  assert.ok(existsSync(join(web, 'carom.wasm')), `${web} holds no built page: ./play --web makes one`);
  server = await serveFolder(web);
});
after(() => server?.close());

test('the page is small enough for a phone', () => {
  const packed = (name) => gzipSync(readFileSync(join(web, name)), {level: 9}).length;
  const module = packed('carom.wasm');
  // What comes only when it is asked for: the editor, and the sources of demos.
  const later = (name) => name === 'carom.wasm' || name === 'sources.json' || name.startsWith('editor-');
  const page = readdirSync(web).filter((n) => !later(n)).reduce((sum, n) => sum + packed(n), 0);
  assert.ok(page <= 400e3, `the page takes ${page} bytes`);
  // The bar is 600 kB; with particles, liquids, cloth, guns, fracture and sports in the gallery it is 1 332 kB.
  assert.ok(module <= 1360e3, `the engine takes ${module} bytes`);
});

test('the engine runs in the page: grab, pause, step, a scene file', async () => {
  const page = await visit(`${server.url}#pyramids`);
  await page.waitForFunction(() => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)[1]) > 20, null, {timeout: 30000});
  const top = await page.evaluate((all) => all.map((i) => [i, window.caromPage.viewer.bodyPosition(i)]).sort((a, b) => b[1][1] - a[1][1])[0][0], await bodies(page, 'dynamic'));
  const at = await screen(page, top), before = await place(page, top);
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  await page.waitForTimeout(200);
  await page.mouse.move(at.x, at.y - 90, {steps: 10});
  await page.waitForTimeout(1500);
  assert.ok((await place(page, top))[1] > before[1] + 0.3, 'the body follows the pointer');
  await picture(page, 'web');
  await page.mouse.up();
  await page.click('#run');
  await until(page, 'Run');
  const held = await stepOf(page);
  await page.click('#step');
  await page.waitForFunction((n) => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)[1]) === n, held + 1);
  await page.evaluate(() => { location.hash = 'scene:newton_cradle'; });
  await page.waitForFunction(() => document.title.includes('radle'));
  await page.done();
});

/** In the page: the state hash of a demo after so many steps, by an engine of its own. */
function hashAfter([demo, count]) {
  return new Promise((resolve, reject) => {
    const worker = new Worker('worker.js', {type: 'module'});
    const send = (message) => worker.postMessage(JSON.stringify(message));
    let asked = 0;  // a status comes whenever a demo has something to say, also in the midst of the steps asked for
    worker.onmessage = ({data}) => {
      if (typeof data === 'string') {
        const message = JSON.parse(data);
        if (message.type === 'error') reject(new Error(message.message));
        if (message.type === 'opened') send({type: 'pause'});
        if (message.type !== 'status' || message.running || message.step < asked || message.step >= count) return;
        asked = Math.min(count, message.step + 100);
        send({type: 'step', count: asked - message.step});
        return;
      }
      const view = new DataView(data);
      if (view.getUint8(0) !== 2) return;
      send({type: 'ack', sequence: view.getUint32(4, true)});
      if (view.getUint32(8, true) < count || !(view.getUint8(1) & 2)) return;
      worker.terminate();
      resolve(view.getBigUint64(view.byteLength - 16, true).toString(16).padStart(16, '0'));
    };
    send({type: 'hello', protocol: 1});
    send({type: 'open', demo});
  });
}

test(`state hashes after ${steps} steps: native and WebAssembly in Chromium`, {timeout: 1800e3}, async () => {
  const page = await visit(server.url);
  const listed = JSON.parse((await promisify(execFile)(carom, ['list', '--json'], {maxBuffer: 1 << 26})).stdout);
  const only = process.env.HASH_DEMOS?.split(',');
  const names = [...listed.demos.map((d) => d.demo), ...listed.scenes.map((d) => `scene:${d.demo}`), ...(only ? listed.stress.map((d) => d.demo) : [])]
    .filter((name) => !only || only.includes(name));
  for (const name of names) {
    const {stdout} = await promisify(execFile)(carom, ['run', name.replace(/^scene:/, ''), '--steps', String(steps), '--json', '--no-record', '--no-pictures', '--out', '/tmp/carom_page_hash'], {maxBuffer: 1 << 26})
      .catch((error) => error);  // a failed expectation is not this test's matter
    const native = JSON.parse(stdout);
    assert.equal(await page.evaluate(hashAfter, [name, native.steps]), native.state_hash, name);
  }
  await page.done();
});
