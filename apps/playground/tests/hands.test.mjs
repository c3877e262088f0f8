// What one does to a scene and asks of it: going back in time, slow motion, cameras, shooting, probing, asking why, three
// fingers, a gamepad, the keyboard alone.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {at, beyond, bodies, hashAt, drawn, movedFrom, PATIENCE, paused, picture, place, runFor, screen, serve, slide, stepOf, until, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());
const open = (demo, options) => visit(`${server.url}#${demo}`, options);
const middle = async (page) => { const b = await page.locator('#view').boundingBox(); return {x: b.x + b.width / 2, y: b.y + b.height / 2}; };

test('a step back, a scrub to the past, and on from there with the same bits', async () => {
  const page = await open('wrecking-ball?step=90'), end = 90;
  await at(page, end);
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
    // A probe asks at most twenty times a second: the pointer moves until it has. The first answer may be one that the
    // tool before this had asked for.
    let said = '';
    for (const since = Date.now(); !text.test(said) && Date.now() - since < PATIENCE;) {
      await page.mouse.move(there.x + Date.now() % 2, there.y + 30);
      said = await page.textContent('#probe');
    }
    assert.match(said, text);
  }
  await page.done();
});

test('slow motion shows a tenth of what passes', async () => {
  const page = await open('chain');
  // From when the host says so: pictures of before may still be under way.
  const told = page.evaluate(() => new Promise((resolve) => {
    const message = window.caromPage.message.bind(window.caromPage);
    window.caromPage.message = (m) => {
      message(m);
      if (m.type === 'status' && m.speed === 0.1) { window.since = performance.now(); resolve(m.step); }
    };
  }));
  await page.selectOption('#speed', '0.1');
  const before = await told;
  await beyond(page, before + 12);
  const {steps, seconds} = await page.evaluate((n) => ({steps: window.caromPage.shown - n, seconds: (performance.now() - window.since) / 1000}), before);
  assert.ok(steps / 60 < 0.15 * seconds + 0.1, `${steps} steps in ${seconds} s`);
  await page.done();
});

test('a drag beside bodies looks around, the wheel comes closer, Home goes back; in the plane a drag moves the paper', async () => {
  const page = await open('joints');
  await paused(page);
  await page.emulateMedia({reducedMotion: 'reduce'});
  await page.keyboard.press('Home');
  const view = () => page.evaluate(() => window.caromPage.viewer.viewpoint);
  const distance = (v) => Math.hypot(v[0] - v[3], v[1] - v[4], v[2] - v[5]);
  const settled = (from, what) => page.waitForFunction(([v, w]) => {
    const now = window.caromPage.viewer.viewpoint, moved = now.some((x, i) => Math.abs(x - v[i]) > 0.05);
    return w ? moved : !moved;
  }, [from, what]);
  const home = await view(), box = await page.locator('#view').boundingBox(), sky = {x: box.x + 60, y: box.y + 90};
  await page.mouse.move(sky.x, sky.y);
  await page.mouse.down();
  await page.mouse.move(sky.x + 120, sky.y + 40, {steps: 5});
  await page.mouse.up();
  await settled(home, true);
  const turned = await view();
  assert.ok(Math.abs(distance(turned) / distance(home) - 1) < 1e-3, 'as far away as before');
  assert.deepEqual(turned.slice(3), home.slice(3), 'and at the same place');
  await page.mouse.wheel(0, -400);
  await page.waitForFunction((d) => { const v = window.caromPage.viewer.viewpoint; return Math.hypot(v[0] - v[3], v[1] - v[4], v[2] - v[5]) < 0.9 * d; }, distance(home));
  await page.keyboard.press('Home');
  await settled(home, false);
  await page.evaluate(() => { location.hash = 'card-house'; });
  await page.waitForFunction(() => window.caromPage.opened.demo === 'card-house' && window.caromPage.shown >= 0);
  const flat = await view();
  await page.mouse.move(sky.x, sky.y);
  await page.mouse.down();
  await page.mouse.move(sky.x + 100, sky.y, {steps: 5});
  await page.mouse.up();
  await settled(flat, true);
  const moved = await view();
  assert.ok(moved[3] < flat[3] - 0.1 && Math.abs(moved[4] - flat[4]) < 1e-6, `${flat} became ${moved}`);
  await page.done();
});

test('three fingers hold three bodies', async () => {
  const page = await open('pyramids?step=5', {hasTouch: true});
  await at(page, 5);
  await drawn(page);
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
