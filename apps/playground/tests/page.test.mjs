// The page against the real engine: `carom serve` and headless Chromium.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {axe, bodies, demosOf, picture, place, screen, serve, stepOf, until, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());
const open = (demo, options) => visit(`${server.url}${demo ? `#${demo}` : ''}`, options);

test('the page lists the demos and shows the first one moving', async () => {
  const page = await open('');
  assert.ok((await demosOf(page)).length >= 12);
  await page.done();
});

test('every demo opens, moves or stands, shows its numbers, and is accessible', async () => {
  const page = await open('');
  const demos = await demosOf(page);
  for (const demo of demos) {
    await page.evaluate((d) => { location.hash = d; }, demo);
    await page.waitForFunction((d) => document.querySelector(`#demos a[aria-current]`)?.dataset.demo === d, demo);
    await page.waitForFunction(() => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)?.[1]) > 5, null, {timeout: 60000}); // software GL, and scenes of thousands of bodies
    await page.waitForTimeout(250);
    await picture(page, demo);
    assert.notEqual(await page.textContent('#numbers'), '', demo);
    assert.ok((await page.textContent('#about')).length > 20, `${demo} says what it shows`);
    await page.evaluate(axe);
    const serious = await page.evaluate(async () => (await window.axe.run()).violations.filter((v) => ['serious', 'critical'].includes(v.impact))
      .map((v) => `${v.id}: ${v.nodes.map((n) => n.target).join(' ')}`));
    assert.deepEqual(serious, [], demo);
  }
  await page.done();
});

test('pause holds, step advances by one, restart begins anew, run goes on', async () => {
  const page = await open('wrecking-ball');
  await page.click('#run');
  await until(page, 'Run');
  await page.waitForTimeout(200);
  const held = await stepOf(page);
  await page.waitForTimeout(300);
  assert.equal(await stepOf(page), held);
  await page.click('#step');
  await page.waitForFunction((n) => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)[1]) === n, held + 1);
  await page.click('#restart');
  await page.waitForFunction((n) => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)[1]) < n, held);
  await page.done();
});

test('a body is grabbed with the mouse, follows it, and falls when let go', async () => {
  const page = await open('pyramids');
  await page.waitForTimeout(400);
  const ids = await bodies(page, 'dynamic');
  // The highest body: nothing stands in front of a pyramid's top.
  const top = await page.evaluate((all) => all.map((i) => [i, window.caromPage.viewer.bodyPosition(i)])
    .filter(([i]) => { const s = window.caromPage.viewer.screenOf(i), b = document.querySelector('#view').getBoundingClientRect();
      return s.x > b.left + 40 && s.x < b.right - 40 && s.y > b.top + 120 && s.y < b.bottom - 80; })
    .sort((a, b) => (b[1][1] - a[1][1]) || (b[1][2] - a[1][2]))[0][0], ids);
  const at = await screen(page, top), before = await place(page, top);
  await page.mouse.move(at.x, at.y);
  await page.mouse.down();
  await page.waitForTimeout(150);
  await page.mouse.move(at.x, at.y - 90, {steps: 12});
  await page.waitForTimeout(1200);
  const lifted = await place(page, top);
  assert.ok(lifted[1] > before[1] + 0.5, `lifted from ${before[1]} to ${lifted[1]}`);
  await picture(page, 'grabbed');
  await page.mouse.up();
  await page.waitForTimeout(2500);
  assert.ok((await place(page, top))[1] < lifted[1] - 0.5);
  await page.done();
});

test('a slider changes its parameter and the plot fills', async () => {
  const page = await open('collision-lab-2d');
  const slider = page.locator('#parameters input[type=range]').first();
  const number = page.locator('#parameters input[type=number]').first();
  const before = await number.inputValue();
  await slider.focus();
  for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowLeft');
  await page.waitForTimeout(300);
  assert.notEqual(await number.inputValue(), before);
  await page.waitForSelector('#plot canvas');
  await page.done();
});

test('the hovercraft is driven by keys', async () => {
  const page = await open('hovercraft');
  await page.focus('#view');
  const craft = (await bodies(page, 'dynamic'))[0], before = await place(page, craft);
  await page.keyboard.down('ArrowUp');
  await page.waitForTimeout(1200);
  await page.keyboard.up('ArrowUp');
  const after = await place(page, craft);
  assert.ok(Math.hypot(after[0] - before[0], after[1] - before[1]) > 0.3, `${before} → ${after}`);
  await page.done();
});

test('a phone of 360 pixels shows the view, opens the menu and the panel', async () => {
  const page = await open('wrecking-ball', {viewport: {width: 360, height: 740}, hasTouch: true, isMobile: true});
  const box = await page.locator('#view').boundingBox();
  assert.ok(box.width > 350 && box.height > 400);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing sticks out');
  await page.tap('#menu');
  await page.waitForTimeout(200);
  await picture(page, 'phone_menu');
  await page.tap('#demos a >> nth=1');
  await page.tap('#panel-toggle');
  await page.waitForTimeout(800);
  await picture(page, 'phone_panel');
  await page.done();
});

test('dark theme', async () => {
  const page = await open('wrecking-ball', {colorScheme: 'dark'});
  await page.waitForTimeout(1500);
  await picture(page, 'dark');
  await page.done();
});

test('a lost connection is said, and mended when the server is back', async () => {
  const own = await serve();
  const page = await visit(`${own.url}#wrecking-ball`);
  await page.evaluate(() => window.caromPage.send({type: 'set', name: 'angle', value: 0.5}));
  await page.waitForFunction(() => window.caromPage.share.link().parameters.angle === 0.5);
  await page.click('#run');
  await until(page, 'Run');
  const held = await stepOf(page);
  own.close();
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /connection/);
  const again = await serve(new URL(own.url).port);
  await page.waitForSelector('#notice', {state: 'hidden', timeout: 15000});
  await page.waitForFunction((n) => Number(document.querySelector('#clock').textContent.match(/step (\d+)/)[1]) === n, held);
  assert.equal((await page.evaluate(() => window.caromPage.share.link())).parameters.angle, 0.5, 'as it was');
  again.close();
});

test('a demo shows the C++ that makes it', async () => {
  const page = await open('rolling');
  await page.click('text=The C++ that makes it');
  await page.waitForFunction(() => document.querySelector('.source').textContent.includes('void build(Stage3& stage)'));
  assert.ok(!(await page.textContent('.source')).includes('#include'));
  await page.done();
});
