// The page without a server of ours: the folder that `./play --web` builds, with the engine as WebAssembly in a Worker.
// WEB names the folder.
import assert from 'node:assert/strict';
import {execFile, execFileSync} from 'node:child_process';
import {existsSync, readFileSync, readdirSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';
import {gzipSync} from 'node:zlib';
import {at, beyond, bodies, carom, demosOf, holding, ISOLATED, paused, picture, place, root, screen, serveFolder, visit} from './harness.mjs';

const web = process.env.WEB ?? join(dirname(fileURLToPath(import.meta.url)), '../../../out/web');

let server, isolated;
before(async () => {
  assert.ok(existsSync(join(web, 'carom.wasm')), `${web} holds no built page: ./play --web makes one`);
  server = await serveFolder(web);
  isolated = await serveFolder(web, ISOLATED);
});
after(() => { server?.close(); isolated?.close(); });

const MOST = 720e3;  // bytes of the engine, gzipped, that a demo or scene needs before it runs
const packed = (name) => gzipSync(readFileSync(join(web, name)), {level: 9}).length;

test('the list of demos that the page was built with is what the engine declares', async () => {
  const listed = JSON.parse(execFileSync(carom, ['list', '--json'], {maxBuffer: 1 << 28, cwd: root}));
  const entry = (prefix) => ({demo, title, summary, group, chapter, dimension}) => ({id: prefix + demo, title, summary, group, chapter, dimension});
  const declared = [...listed.demos.map(entry('')), ...listed.scenes.map(entry('scene:')), ...listed.stress.map(entry(''))];
  assert.deepEqual(JSON.parse(JSON.parse(readFileSync(join(web, 'files.json'), 'utf8')).menu), declared);
  const page = await visit(server.url, {}, false);
  await page.waitForSelector('#demo-list a');
  assert.deepEqual((await demosOf(page)).sort(), declared.map((d) => d.id).sort());
  await page.done();
});

/** The engine's files that a page asks for. */
function engineFiles(page) {
  const asked = new Set();
  page.on('request', (request) => {
    const name = new URL(request.url()).pathname.slice(1);
    if (name.endsWith('.wasm')) asked.add(name);
  });
  return asked;
}

test('the page is small enough for a phone', () => {
  // What comes only when it is asked for: the editor, texts and sources of demos, each picture when it is scrolled to, and
  // the engine with its parts, which are counted below.
  const later = (name) => name.endsWith('.wasm') || ['sources.json', 'lessons.json', 'thumbnails'].includes(name) || name.startsWith('editor-');
  const page = readdirSync(web).filter((n) => !later(n)).reduce((sum, n) => sum + packed(n), 0);
  assert.ok(page <= 400e3, `the page takes ${page} bytes`);
  const engine = readdirSync(web).filter((n) => n.endsWith('.wasm')).map((n) => packed(n));
  assert.ok(Math.max(...engine) <= 450e3, `a file of the engine takes ${Math.max(...engine)} bytes`);
  assert.ok(engine.reduce((sum, n) => sum + n) <= 2400e3, `the engine and all its parts take ${engine.reduce((sum, n) => sum + n)} bytes`);
});

test('a demo fetches of the engine what it needs and no more: the first one its first file alone', async () => {
  const page = await visit('about:blank', {}, false), asked = engineFiles(page);
  await page.goto(`${server.url}#wrecking-ball`);
  await page.waitForFunction(() => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)?.[1]) > 200);
  assert.deepEqual([...asked], ['carom.wasm']);
  for (const demo of ['powered_ragdoll', 'pool-table', 'scene:breaking_things']) {
    const own = await visit('about:blank', {}, false), files = engineFiles(own);
    await own.goto(`${server.url}#${demo}`);
    await beyond(own, 10);
    const bytes = [...files].reduce((sum, name) => sum + packed(name), 0);
    assert.ok(files.size > 1 && bytes <= MOST, `${demo}: ${bytes} bytes of ${[...files]}`);
    await own.close();
  }
  await page.done();
});

test('no demo and no scene file fetches more than 720 kB of engine before it runs, nor asks for many files', async () => {
  const {menu} = JSON.parse(readFileSync(join(web, 'files.json'), 'utf8')), demos = JSON.parse(menu).map((d) => d.id);
  const scenes = readdirSync(join(root, 'scenes')).filter((n) => n.endsWith('.json')).map((n) => `scene:${n.slice(0, -5)}`);
  assert.deepEqual(scenes.filter((s) => !demos.includes(s)), [], 'every scene file is in the list');
  const {stdout} = await promisify(execFile)(process.execPath, ['--no-warnings', '--liftoff-only', fileURLToPath(new URL('node_fetched.mjs', import.meta.url)), web, '20', ...demos], {maxBuffer: 1 << 26});
  const listed = JSON.parse(execFileSync(carom, ['list', '--json'], {maxBuffer: 1 << 28, cwd: root}));
  const words = new Map([...listed.demos, ...listed.stress].map((d) => [d.demo, d]).concat(listed.scenes.map((d) => [`scene:${d.demo}`, d])));
  const size = new Map(), found = stdout.trim().split('\n').map((line) => JSON.parse(line));
  const bytes = (name) => { if (!size.has(name)) size.set(name, packed(name)); return size.get(name); };
  assert.deepEqual(found.map((f) => f.demo), demos);
  for (const one of found) {
    assert.ok(one.seen > 0 && !one.wrong, `${one.demo} ran: ${one.wrong}`);
    // Its sentences came with it.
    assert.deepEqual(one.words, [words.get(one.demo).summary, words.get(one.demo).text], one.demo);
    one.bytes = one.files.reduce((sum, name) => sum + bytes(name), 0);
  }
  found.sort((a, b) => b.bytes - a.bytes);
  const told = (f) => `${f.demo} ${(f.bytes / 1000).toFixed(0)} kB in ${f.files.length} files`;
  console.log(`engine fetched, gzipped: at most ${told(found[0])}; half of all under ${told(found[found.length >> 1])}`);
  assert.deepEqual(found.filter((f) => f.bytes > MOST || f.files.length > 16).map(told), []);
});

test('an engine that is not there is named, whether it is missed before the page listens or after', async () => {
  for (const [pattern, late] of [[/carom\.wasm$/, /\/main\.js$/], [/carom\.wasm$/, /nothing/], [/worker\.js$/, /\/main\.js$/]]) {
    const page = await visit('about:blank', {}, false);
    await page.route(late, async (route) => { await new Promise((resolve) => setTimeout(resolve, 2000)); await route.continue(); });
    await page.route(pattern, (route) => route.fulfill({status: 404}));
    await page.goto(`${server.url}#wrecking-ball`);
    await page.waitForFunction(() => /engine (cannot be loaded|of this page stopped)/.test(document.querySelector('#notice').textContent));
    await page.close();
  }
});

test('a browser without SIMD in WebAssembly is told from when on browsers have it', async () => {
  const page = await visit('about:blank', {}, false);
  await page.route(/worker\.js$/, async (route) => {
    const answer = await route.fetch();
    await route.fulfill({response: answer, body: `WebAssembly.validate = () => false;\n${await answer.text()}`});
  });
  await page.goto(`${server.url}#chain`);
  await page.waitForFunction(() => /SIMD.*Safari from 16\.4/.test(document.querySelector('#notice').textContent));
});

test('a part of the engine that is not there is named', async () => {
  const page = await visit('about:blank', {}, false);
  await page.route(/carom-[a-z0-9-]+-[0-9a-f]{8}\.wasm$/, (route) => route.fulfill({status: 404}));
  await page.goto(`${server.url}#pool-table`);
  await page.waitForFunction(() => document.querySelector('#notice').textContent.includes('Reload the page'));
  for (let i = 0; i < 100 && page.problems.length === 0; ++i) await page.waitForTimeout(50);  // what the page threw comes by another way
  assert.match(page.problems.join(), /carom-.*wasm: the server answers 404/);
});

test('the engine runs in the page: grab, pause, step, a scene file', async () => {
  const page = await visit(`${server.url}#pyramids`);
  await beyond(page, 20);
  // A pyramid's top well inside the view: micrometres decide which of the twenty is the highest, and some lie outside.
  const top = await page.evaluate((all) => all.map((i) => [i, window.caromPage.viewer.bodyPosition(i)])
    .filter(([i]) => { const s = window.caromPage.viewer.screenOf(i), b = document.querySelector('#view').getBoundingClientRect();
      return s.x > b.left + 40 && s.x < b.right - 40 && s.y > b.top + 120 && s.y < b.bottom - 80; })
    .sort((a, b) => b[1][1] - a[1][1])[0][0], await bodies(page, 'dynamic'));
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

const threadsOf = (page) => page.evaluate(() => Number(document.querySelector('#numbers').textContent.match(/on (\d+) thread/)?.[1]));

test('a page that its server isolates runs the engine on several threads', async () => {
  const page = await visit(`${isolated.url}#pyramids`);
  await beyond(page, 60);
  const processors = await page.evaluate(() => (crossOriginIsolated ? navigator.hardwareConcurrency : 0));
  assert.equal(await threadsOf(page), Math.min(8, processors));
  await page.done();
  const plain = await visit(`${server.url}#pyramids`);
  await beyond(plain, 60);
  assert.equal(await threadsOf(plain), 1);
  await plain.done();
});
