// What one sees: layers of debug drawing, heat, trails, shadows, themes, sizes of text, numbers and warnings.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {at, barriers, beyond, bodies, drawn, paused, picture, runFor, serve, stepOf, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());
const open = (demo, options) => visit(`${server.url}#${demo}`, options);

/** What the layers of debug drawing must show where: each has something of its kind somewhere. */
const SHOWN = {
  joints: ['bounds', 'centers', 'joints', 'errors', 'islands', 'velocities', 'forces'],
  'card-house': ['bounds', 'centers', 'contacts', 'colors', 'errors', 'islands', 'forces'],
  'scene:floating_boxes': ['bounds', 'effectors', 'water'],
};

test('every layer of debug drawing, in space and in the plane', async () => {
  const all = new Set();
  let names;
  for (const [demo, shown] of Object.entries(SHOWN)) {
    const page = await open(demo);
    const lines = () => page.evaluate(() => window.caromPage.viewer.lineCount);
    await beyond(page, 40);
    await paused(page);
    const layers = page.locator('#layers input[data-layer]'), bare = await lines();
    const without = [];  // which need what this scene lacks
    names = await layers.evaluateAll((boxes) => boxes.map((box) => box.dataset.layer));
    let now = await stepOf(page);
    for (const [i, name] of names.entries()) {
      // One alone, and a step with it.
      await layers.evaluateAll((boxes, place) => { boxes.forEach((box, k) => { if (box.checked !== (k === place)) box.click(); }); document.querySelector('#step').click(); }, i);
      await at(page, ++now);
      if (await lines() <= bare) without.push(name);
    }
    for (const needed of shown) { assert.ok(!without.includes(needed), `${demo}: no lines of ${without}`); all.add(needed); }
    for (const box of await layers.all()) await box.check();
    await page.click('#run');
    await runFor(page, 20);
    await picture(page, `layers ${demo}`);
    await page.locator('#timing').scrollIntoViewIfNeeded();
    await picture(page, `numbers ${demo}`);
    await page.done();
  }
  assert.deepEqual(names.filter((name) => !all.has(name)), [], 'layers that no scene shows');
});

test('heat colours tell speeds, trails tell ways', async () => {
  const page = await open('wrecking-ball?step=40');
  await at(page, 40);
  const colors = () => page.evaluate(() => {
    const seen = new Set();
    for (const batch of window.caromPage.viewer.bodies.batches.values()) for (let i = 0; i < batch.mesh.count; ++i) seen.add([...batch.mesh.instanceColor.array.slice(3 * i, 3 * i + 3)].map((x) => x.toFixed(3)).join());
    return seen.size;
  });
  const own = await colors();
  await page.check('#layers >> text=Heat colours');
  await page.check('#layers >> text=Trails');
  await page.waitForSelector('#legend', {state: 'visible'});
  await page.click('#run');
  await runFor(page, 20);
  assert.match(await page.textContent('#legend-top'), /^(1|2|5|10|20) m\/s$/);
  assert.ok(own < 40 && await colors() > 3, 'fast and slow bodies differ');
  assert.ok(await page.evaluate(() => [...window.caromPage.viewer.bodies.drawn.values()].some((d) => d.heat > 1)));
  assert.ok(await page.evaluate(() => window.caromPage.viewer.bodies.trails.group.children.some((line) => line.geometry.drawRange.count > 5)));
  await picture(page, 'heat and trails');
  await page.uncheck('#layers >> text=Heat colours');
  assert.ok(await colors() < 40, 'their own colours again');
  await page.done();
});

test('a theme of one\'s own, text for the last row, shadows, and a wall of pixels', async () => {
  const page = await open('pyramids', {colorScheme: 'light'});
  await beyond(page, 5);
  await paused(page);
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await paper();
  await page.selectOption('#theme', 'dark');
  assert.notEqual(await paper(), light);
  assert.deepEqual(await barriers(page, {exclude: ['#demos']}), []);
  await picture(page, 'dark by choice');
  await page.selectOption('#theme', '');
  const size = () => page.$eval('#about .summary', (e) => parseFloat(getComputedStyle(e).fontSize));
  const small = await size();
  await page.selectOption('#text-size', 'largest');
  assert.ok(await size() > 1.5 * small && await size() >= 22, `${await size()} px`);
  assert.ok(await page.evaluate(() => document.querySelector('#panel').scrollWidth <= document.querySelector('#panel').clientWidth + 1), 'nothing sticks out of the panel');
  await page.waitForSelector('#plot canvas');
  await picture(page, 'last row');
  await page.selectOption('#text-size', '');
  // A shadow darkens the ground.
  await drawn(page);
  await drawn(page);
  const brightness = () => page.evaluate(async () => {
    const view = await createImageBitmap(await window.caromPage.viewer.picture()), canvas = new OffscreenCanvas(100, 70);
    const ink = canvas.getContext('2d');
    ink.drawImage(view, 0, 0, 100, 70);
    return ink.getImageData(0, 0, 100, 70).data.reduce((sum, x) => sum + x, 0) / 28000;
  });
  const shaded = await brightness();
  await page.uncheck('#layers >> text=Shadows');
  await drawn(page);
  const plain = await brightness();
  assert.ok(plain > shaded + 0.1, `without shadows it is brighter: ${shaded}, ${plain}`);
  await page.setViewportSize({width: 3840, height: 2160});
  assert.ok(await size() > 1.4 * small, 'larger on a wall');
  await picture(page, 'demo 4k');
  await page.done();
});

test('numbers: budget, stages, warnings with advice', async () => {
  const page = await open('chain');
  const scene = {name: 'Fast ball', dimension: 3, gravity: [0, 0, 0], world: {continuous: false}, bodies: [
    {name: 'wall', type: 'fixed', position: ['2 km', 0, 0], shape: {type: 'box', size: [0.1, 4, 4]}},
    {name: 'ball', velocity: ['40 m/s', 0, 0], density: 1000, shape: {type: 'sphere', radius: '0.05 m'}}]};
  await page.evaluate((text) => window.caromPage.send({type: 'open_scene', name: 'fast.json', text}), JSON.stringify(scene));
  await page.waitForFunction(() => document.title.includes('Fast ball') && window.caromPage.shown > 20 && document.querySelector('#numbers').textContent.includes('2 (1 awake)'));
  await page.waitForFunction(() => document.querySelectorAll('#timing-legend li').length > 3);
  const rows = await page.$$eval('#numbers dt, #budget dt', (all) => all.map((e) => `${e.textContent}: ${e.nextElementSibling.textContent}`));
  for (const wanted of [/^Bodies: 2 /, /^Contacts: 0$/, /^Kinetic energy: 418\.\d* J/, /^Momentum: 20\.9\d* kg·m\/s/, /^Angular momentum: /, /^Mass: 0\.523\d* kg/, /^State hash: [0-9a-f]{16}$/, /^Memory: /])
    assert.ok(rows.some((row) => wanted.test(row)), `${wanted}: ${rows.join('; ')}`);
  await page.evaluate((id) => window.caromPage.choose(id), (await bodies(page, 'dynamic'))[0]);
  await page.waitForSelector('#why .warning');
  assert.match(await page.textContent('#why .summary'), /ball \(dynamic\) is awake: it moves at 40/);
  assert.match(await page.textContent('#why .warning'), /0\.667 m in a step.*set continuous/);
  await picture(page, 'warning');
  await page.done();
});

/** For every kind of warning a scene that earns it, the body to ask about, and what the advice must say. */
const WARNINGS = {
  'a mass that is far too heavy for what bears it': [{world: {allow_sleep: false}, bodies: [{type: 'fixed', shape: {type: 'plane', normal: [0, 1, 0]}},
    {name: 'light', position: [0, 0.5, 0], density: 1, shape: {type: 'box', size: [1, 1, 1]}}, {name: 'top', position: [0, 1.5, 0], density: 1e9, shape: {type: 'box', size: [1, 1, 1]}}]}, 'top', /will sink by/, /masses nearer/],
  'a chain with a heavy end': [{world: {allow_sleep: false, joint_solver: 'iterative'}, bodies: [0, 1, 2, 3, 4, 5, 6, 7].map((i) => ({name: `c${i}`, position: [0, -0.5 - i, 0], density: i === 7 ? 20000 : 100, shape: {type: 'box', size: [0.2, 1, 0.2]}})),
    joints: [0, 1, 2, 3, 4, 5, 6, 7].map((i) => ({type: 'ball', body_a: i ? `c${i - 1}` : 'world', body_b: `c${i}`, anchor: [0, -i, 0]}))}, 'c7', /hang low/, /substeps/],
  'a spring too stiff': [{bodies: [{name: 'mass', position: [0, -1, 0], shape: {type: 'sphere', radius: 0.2}}],
    joints: [{type: 'distance', body_a: 'world', body_b: 'mass', anchor_a: [0, 0, 0], anchor_b: [0, -1, 0], length: 1, spring: {frequency: 60, damping_ratio: 0}}]}, 'mass', /spring of 60 Hz/, /9 substeps/],
  'contacts stiffer than the step permits': [{world: {contact_frequency: 60}, bodies: [{name: 'ball', position: [0, 1, 0], shape: {type: 'sphere', radius: 0.2}}]}, 'ball', /capped at 36 Hz/, /7 substeps/],
  'a fast ball': [{gravity: [0, 0, 0], world: {continuous: false}, bodies: [{name: 'ball', velocity: [40, 0, 0], shape: {type: 'sphere', radius: 0.05}}]}, 'ball', /in a step/, /continuous/],
};

test('every kind of warning is told of the body that it is about, with what mends it', async () => {
  const page = await open('chain');
  for (const [name, [scene, body, what, cure]] of Object.entries(WARNINGS)) {
    // A few steps and no more: what is warned of may be over soon.
    await page.evaluate((text) => [{type: 'open_scene', name: 'warned.json', text}, {type: 'pause'}, {type: 'step', count: 5}].forEach((message) => window.caromPage.send(message)), JSON.stringify({name, dimension: 3, ...scene}));
    await page.waitForFunction(([title, wanted]) => {
      const {viewer} = window.caromPage, id = viewer.bodyIds('dynamic').find((one) => viewer.nameOf(one) === wanted);
      if (!document.title.includes(title) || id === undefined) return false;
      window.caromPage.choose(id);
      return true;
    }, [name, body]);
    await page.waitForFunction((words) => {
      const said = [...document.querySelectorAll('#why .warning')].map((e) => e.textContent).join(' ');
      return words.every((word) => RegExp(word).test(said));
    }, [what.source, cure.source]).catch(async (error) => assert.fail(`${name}: ${await page.textContent('#why')} (${error.message})`));
  }
  await picture(page, 'warnings');
  await page.done();
});

test('a browser without WebGL2 is told what it lacks', async () => {
  const page = await visit('about:blank', {sparing: false}, false);
  await page.addInitScript(() => {
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind.startsWith('webgl') ? null : own.call(this, kind, ...rest); };
  });
  await page.goto(server.url);
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /needs WebGL2/);
});

test('a browser whose system has no language, and that lacks what the page can do without', async () => {
  const page = await visit('about:blank', {}, false);
  await page.addInitScript(() => {
    Object.defineProperty(navigator, 'language', {value: 'C', configurable: true});
    for (const name of ['SharedArrayBuffer', 'OffscreenCanvas', 'createImageBitmap']) delete window[name];
    Object.defineProperty(Navigator.prototype, 'getGamepads', {value: undefined});
    Object.defineProperty(Navigator.prototype, 'clipboard', {value: undefined});
  });
  await page.goto(`${server.url}#chain`);
  await beyond(page, 10);
  await page.waitForSelector('#plot canvas');
  await page.click('#share >> text=Copy link');
  await page.waitForFunction(() => document.querySelector('#notice').textContent.includes('address line'));
  await page.done();
});
