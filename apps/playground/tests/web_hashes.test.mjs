// Every demo and scene leads to the same bits natively and as WebAssembly in Chromium, with one thread and several. WEB names the folder that
// `./play --web` builds, MODULE the whole engine before it is cut; HASH_STEPS and HASH_DEMOS (names with commas between them)
// ask for other runs. Scenes run in Node too; there tools/check_determinism.sh runs the demos.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';
import {carom, ISOLATED, root, serveFolder, visit} from './harness.mjs';

const web = process.env.WEB ?? join(dirname(fileURLToPath(import.meta.url)), '../../../out/web');
const whole = process.env.MODULE ?? join(root, 'build/wasm/apps/wasm/carom.wasm');
const steps = Number(process.env.HASH_STEPS ?? 300);
// One scene would take as long as two thirds of the others together.
const stepsOf = (name) => (name === 'scene:soft_bodies' ? Math.min(steps, 150) : steps);
const scratch = mkdtempSync(join(tmpdir(), 'carom-hashes-'));

let server, isolated;
before(async () => { server = await serveFolder(web); isolated = await serveFolder(web, ISOLATED); });
after(() => { server?.close(); isolated?.close(); rmSync(scratch, {recursive: true, force: true}); });

/** In the page: state hashes of demos after so many steps, one after another, in one engine of its own, which stays for the next ones. */
function hashesAfter(runs) {
  return new Promise((resolve, reject) => {
    const first = !window.engine, worker = window.engine ??= new Worker('worker.js', {type: 'module'}), hashes = [];
    const send = (message) => worker.postMessage(JSON.stringify(message));
    let asked = 0, opened = false, demo, count;
    const next = () => {
      if (hashes.length === runs.length) { resolve(hashes); return; }
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
    if (first) send({type: 'hello', protocol: 1});
    next();
  });
}

test(`state hashes after ${steps} steps: native and WebAssembly, in Chromium with one thread and several, and in Node`, {timeout: 3000e3}, async () => {
  const run = promisify(execFile), limits = {maxBuffer: 1 << 26, cwd: root};
  const listed = JSON.parse((await run(carom, ['list', '--json'], limits)).stdout);
  const only = process.env.HASH_DEMOS?.split(',');
  // Scenes first: they run in Node while demos run in the pages.
  const names = [...listed.scenes.map((d) => `scene:${d.demo}`), ...listed.demos.map((d) => d.demo), ...(only ? listed.stress.map((d) => d.demo) : [])]
    .filter((name) => !only || only.includes(name));
  // Pages without a demo of their own: nothing else takes the processors. One thread, and as many as there are processors.
  const page = await visit(`${server.url}worker.js`, {}, false), threaded = await visit(`${isolated.url}worker.js`, {}, false);
  assert.ok(await threaded.evaluate(() => crossOriginIsolated));
  const nativeOf = async (some) => {
    const native = [];
    for (const name of some) {
      const {stdout} = await run(carom, ['run', name.replace(/^scene:/, ''), '--steps', String(stepsOf(name)), '--json', '--no-record', '--no-pictures', '--out', scratch], limits)
        .catch((error) => error);  // a failed expectation is not this test's matter
      native.push(JSON.parse(stdout));
    }
    return native;
  };
  const nodeOf = async (some) => {
    const {stdout} = await run(process.execPath, ['--no-warnings', '--liftoff-only', fileURLToPath(new URL('node_hashes.mjs', import.meta.url)), whole, join(web, 'files.json'),
      ...some.map((s) => `${s.name}=${s.steps}`)], limits);
    const found = stdout.trim().split('\n');
    some.forEach((s, k) => assert.equal(found[k], s.state_hash, `${s.name} in Node`));
  };
  const parts = Array.from({length: Math.ceil(names.length / 13)}, (_, i) => names.slice(13 * i, 13 * i + 13));
  let next = nativeOf(parts[0]), inNode = Promise.resolve();
  for (const [i, some] of parts.entries()) {
    const native = await next, runs = some.map((name, k) => [name, native[k].steps]);
    if (i + 1 < parts.length) next = nativeOf(parts[i + 1]);  // while the pages are at work
    const scenes = some.map((name, k) => ({name, ...native[k]})).filter((s) => s.name.startsWith('scene:'));
    if (scenes.length > 0) {
      const before = inNode;
      inNode = before.then(() => nodeOf(scenes));
      inNode.catch(() => {});  // it is awaited at the end
    }
    const [found, withThreads] = await Promise.all([page.evaluate(hashesAfter, runs), threaded.evaluate(hashesAfter, runs)]);
    some.forEach((name, k) => assert.equal(found[k], native[k].state_hash, name));
    some.forEach((name, k) => assert.equal(withThreads[k], native[k].state_hash, `${name} with threads`));
  }
  await inNode;
});
