// What one does to a scene and asks of it: going back in time, shooting, probing, asking why, layers, three fingers, a
// gamepad, the keyboard alone.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {at, beyond, bodies, drawn, hashAt, movedFrom, paused, picture, place, runFor, screen, serve, slide, stepOf, until, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());
const open = (demo, options) => visit(`${server.url}#${demo}`, options);
const middle = async (page) => { const b = await page.locator('#view').boundingBox(); return {x: b.x + b.width / 2, y: b.y + b.height / 2}; };

test('a step back, a scrub to the past, and on from there with the same bits', async () => {
  const page = await open('wrecking-ball');
  await beyond(page, 60);
  const end = await paused(page);
  await page.click('#back');
  await at(page, end - 1);
  await slide(page, 30);
  await at(page, 30);
  const ball = (await bodies(page, 'dynamic')).at(-1), then = await place(page, ball);
  await slide(page, end);
  await at(page, end);
  assert.notDeepEqual(await place(page, ball), then);
  const before = await hashAt(page, end);
  await slide(page, 30);
  await at(page, 30);
  assert.deepEqual(await place(page, ball), then, 'the past is as it was');
  await page.evaluate((count) => window.caromPage.send({type: 'step', count}), end - 30);
  await at(page, end);
  assert.equal(await hashAt(page, end), before, 'and leads to the same present');
  await page.done();
});

test('shooting a body, asking why, following it', async () => {
  const page = await open('pyramids');
  const before = (await bodies(page, 'dynamic')).length, there = await middle(page);
  await page.keyboard.press('2');
  await page.mouse.click(there.x, there.y);
  await page.waitForFunction((n) => window.caromPage.viewer.bodyIds('dynamic').length === n, before + 1);
  const shot = (await bodies(page, 'dynamic')).at(-1);
  await page.evaluate((id) => window.caromPage.choose(id), shot);
  await page.waitForSelector('#why-section:not([hidden])');
  assert.match(await page.textContent('#why'), /thrown in.*dynamic/);
  await page.focus('#view');
  await page.keyboard.press('f');
  assert.equal(await page.evaluate(() => window.caromPage.viewer.followed), shot);
  await runFor(page, 60);
  await page.locator('#why-section').scrollIntoViewIfNeeded();
  await picture(page, 'why');
  await page.done();
});

test('probes tell what lies under the pointer', async () => {
  const page = await open('wrecking-ball');
  const there = await middle(page);
  for (const [key, text] of [['3', /along the ray/], ['4', /along the ray/], ['5', /away|nothing/]]) {
    await page.keyboard.press(key);
    // A probe asks at most twenty times a second: the pointer moves until it has.
    let said = '';
    for (let i = 0; said === ''; i = 1 - i) {
      await page.mouse.move(there.x + i, there.y + 30);
      said = await page.textContent('#probe');
    }
    assert.match(said, text);
  }
  await page.done();
});

test('every layer of debug drawing, in space and in the plane', async () => {
  for (const demo of ['joints', 'card-house']) {
    const page = await open(demo);
    const lines = () => page.evaluate(() => window.caromPage.viewer.lineCount);
    await beyond(page, 40);
    await paused(page);
    const layers = page.locator('#layers input[data-layer]'), bare = await lines();
    const without = [];  // which need what this scene lacks
    for (let i = 0; i < await layers.count(); ++i) {
      const name = await layers.nth(i).getAttribute('data-layer');
      await layers.nth(i).check();
      const now = await stepOf(page);
      await page.click('#step');
      await at(page, now + 1);
      if (await lines() <= bare) without.push(name);
      await layers.nth(i).uncheck();
    }
    for (const needed of ['bounds', 'centers', 'islands']) assert.ok(!without.includes(needed), `${demo}: no lines of ${without}`);
    assert.ok(!without.includes(demo === 'joints' ? 'joints' : 'contacts'), `${demo}: no lines of ${without}`);
    for (const box of await layers.all()) await box.check();
    await page.click('#run');
    await runFor(page, 20);
    await picture(page, `layers ${demo}`);
    await page.locator('#timing').scrollIntoViewIfNeeded();
    await picture(page, `numbers ${demo}`);
    await page.done();
  }
});

test('heat colours tell speeds, trails tell ways', async () => {
  const page = await open('wrecking-ball');
  await beyond(page, 30);
  const colors = () => page.evaluate(() => {
    const seen = new Set();
    for (const batch of window.caromPage.viewer.bodies.batches.values()) for (let i = 0; i < batch.mesh.count; ++i) seen.add([...batch.mesh.instanceColor.array.slice(3 * i, 3 * i + 3)].map((x) => x.toFixed(3)).join());
    return seen.size;
  });
  const own = await colors();
  await page.check('#layers >> text=Heat colours');
  await page.check('#layers >> text=Trails');
  await page.waitForSelector('#legend', {state: 'visible'});
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

test('three fingers hold three bodies', async () => {
  const page = await open('pyramids', {hasTouch: true});
  await page.click('#run');
  await until(page, 'Run');
  const ids = (await bodies(page, 'dynamic')).slice(0, 400);
  const spots = [];
  const box = await page.locator('#view').boundingBox();
  for (const id of ids) {
    const s = await screen(page, id);
    if (s.x > box.x + 30 && s.x < box.x + box.width - 30 && s.y > box.y + 60 && s.y < box.y + box.height - 120 && spots.every((o) => Math.hypot(o.x - s.x, o.y - s.y) > 60)) spots.push(s);
    if (spots.length === 3) break;
  }
  assert.equal(spots.length, 3);
  const answers = page.evaluate(() => new Promise((resolve) => {
    const seen = [], message = window.caromPage.message.bind(window.caromPage);
    window.caromPage.message = (m) => { message(m); if (m.type === 'grabbed') { seen.push(m.body); if (seen.length === 3) resolve(seen); } };
  }));
  const client = await page.context().newCDPSession(page);
  const points = spots.map((s, id) => ({x: s.x, y: s.y, id}));
  for (let n = 1; n <= 3; ++n) await client.send('Input.dispatchTouchEvent', {type: 'touchStart', touchPoints: points.slice(0, n)});
  const held = await answers;
  assert.ok(held.every((id) => id >= 0) && new Set(held).size === 3, `held ${held}`);
  await client.send('Input.dispatchTouchEvent', {type: 'touchEnd', touchPoints: []});
  await page.done();
});

test('a gamepad drives the hovercraft', async () => {
  const page = await open('hovercraft');
  const craft = (await bodies(page, 'dynamic'))[0], before = await place(page, craft);
  await page.evaluate(() => {
    const pad = {connected: true, axes: [0, -1], buttons: Array.from({length: 17}, () => ({value: 0, pressed: false}))};
    navigator.getGamepads = () => [pad];
    window.pad = pad;
  });
  await movedFrom(page, craft, before, 0.3);
  await page.done();
});

test('all of it by the keyboard alone', async () => {
  const page = await open('chain');
  await page.focus('#view');
  await page.keyboard.press('Space');
  await until(page, 'Run');
  const held = await stepOf(page);
  await page.keyboard.press('.');
  await at(page, held + 1);
  await page.keyboard.press(',');
  await at(page, held);
  await page.keyboard.press(']');
  await page.waitForSelector('#why-section:not([hidden])');
  await page.keyboard.press('?');
  await page.waitForSelector('#help[open]');
  await picture(page, 'help');
  await page.keyboard.press('Escape');
  await page.waitForSelector('#help:not([open])', {state: 'attached'});
  await page.focus('#view');
  const before = (await bodies(page, 'dynamic')).length;
  await page.keyboard.press('b');
  await page.waitForFunction((n) => window.caromPage.viewer.bodyIds('dynamic').length === n, before + 1);
  // Every control can be reached with the tab key and has a name.
  const nameless = await page.$$eval('button, input, select, a', (all) => all.filter((e) => !e.closest('[hidden], dialog:not([open])') && !(e.getAttribute('aria-label') || e.textContent.trim() || e.labels?.length || e.title)).map((e) => e.outerHTML));
  assert.deepEqual(nameless, []);
  await page.done();
});
