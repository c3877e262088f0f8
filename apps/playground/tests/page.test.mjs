// The page against the real engine: `carom serve` and headless Chromium.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {after, before, test} from 'node:test';
import {arranged, at, barriers, beyond, bodies, carom, demosOf, holding, movedFrom, paused, picture, place, root, runFor, screen, serve, stepOf, until, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());
const open = (demo, options) => visit(`${server.url}${demo ? `#${demo}` : ''}`, options);

test('the start page shows all demos by chapters with pictures, finds them by words, and one comes back to it', async () => {
  const page = await visit(server.url, {viewport: {width: 1280, height: 900}}, false);
  await page.waitForSelector('#demo-list a');
  const demos = await demosOf(page);
  assert.ok(demos.length >= 76 + 16, `${demos.length} demos`);
  assert.equal(new Set(demos).size, demos.length);
  // In the subject's order, what goes beyond it at the end.
  const chapters = await page.$$eval('#demo-list section', (all) => all.map((e) => Number(e.dataset.chapter)));
  assert.ok(new Set(chapters).size > 8, String(chapters));
  assert.deepEqual(chapters, [...chapters].sort((a, b) => a - b));
  // Each has its picture, which comes when it is scrolled to.
  assert.equal(await page.locator('#demo-list img').count(), demos.length);
  assert.ok(await page.$$eval('#demo-list img', (all) => all.some((img) => !img.complete)), 'not all of them at once');
  assert.deepEqual(await page.$$eval('#highlights a', (all) => all.map((a) => a.dataset.demo)), ['wrecking-ball', 'glass-pane', 'fluid-tank', 'pool-table', 'powered_ragdoll', 'trebuchet']);
  assert.ok((await page.locator('#highlights').boundingBox()).height < 250, 'in one row');
  await picture(page, 'start');
  assert.deepEqual(await barriers(page), []);
  for (const image of await page.locator('#demo-list section li:last-child img').all()) await image.scrollIntoViewIfNeeded();
  await page.waitForFunction(() => [...document.querySelectorAll('#demo-list section li:last-child img')].every((img) => img.complete && img.naturalWidth === 400));
  for (const [name, width, height, colorScheme] of [['start phone', 360, 740, 'light'], ['start phone dark', 360, 740, 'dark'], ['start 4k', 3840, 2160, 'light'], ['start 4k dark', 3840, 2160, 'dark']]) {
    await page.setViewportSize({width, height});
    await page.emulateMedia({colorScheme});
    await page.evaluate(() => document.querySelector('#demos').scrollTo(0, 0));
    assert.ok(await page.evaluate(() => document.querySelector('#demos').scrollWidth <= innerWidth), `${name}: nothing sticks out`);
    await page.waitForFunction(() => [...document.querySelectorAll('#demo-list img')].filter((img) => img.getBoundingClientRect().top < innerHeight).every((img) => img.complete));
    await picture(page, name);
  }
  await page.setViewportSize({width: 1280, height: 900});
  await page.fill('#search', 'hover');
  const shown = await page.$$eval('#demo-list li:not([hidden]) a', (links) => links.filter((a) => a.offsetParent).map((a) => a.dataset.demo));
  assert.ok(shown.includes('hovercraft') && shown.length < demos.length / 3, String(shown));
  await page.fill('#search', 'no such thing');
  await page.waitForSelector('#nothing-found', {state: 'visible'});
  await page.fill('#search', 'pyramids twenty');
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.title.includes('pyramids') && window.caromPage.shown > 5);
  await page.goBack();
  await page.waitForSelector('#greeting', {state: 'visible'});
  await page.fill('#search', '');
  await page.click('#demo-list a[data-demo=rolling]');
  await page.waitForFunction(() => document.title.includes('rolling') && window.caromPage.shown >= 0);
  await page.click('h1 a');
  await page.waitForSelector('#greeting', {state: 'visible'});
  await page.evaluate(() => { location.hash = 'nothing-of-this-name'; });
  await page.reload();
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /nothing-of-this-name/);
  await page.done();
});

test('pause holds, step advances by one, restart begins anew, run goes on', async () => {
  const page = await open('wrecking-ball');
  await beyond(page, 20);
  const held = await paused(page);
  await page.waitForTimeout(300);  // nothing may happen meanwhile
  assert.equal(await stepOf(page), held);
  await page.click('#step');
  await at(page, held + 1);
  await page.click('#restart');
  await at(page, 0);
  await page.click('#run');
  await until(page, 'Pause');
  await beyond(page, 5);
  await page.done();
});

test('a body is grabbed with the mouse, follows it, and falls when let go', async () => {
  const page = await open('pyramids');
  await beyond(page, 20);
  const ids = await bodies(page, 'dynamic');
  // The highest body: nothing stands in front of a pyramid's top.
  const top = await page.evaluate((all) => all.map((i) => [i, window.caromPage.viewer.bodyPosition(i)])
    .filter(([i]) => { const s = window.caromPage.viewer.screenOf(i), b = document.querySelector('#view').getBoundingClientRect();
      return s.x > b.left + 40 && s.x < b.right - 40 && s.y > b.top + 120 && s.y < b.bottom - 80; })
    .sort((a, b) => (b[1][1] - a[1][1]) || (b[1][2] - a[1][2]))[0][0], ids);
  const spot = await screen(page, top), before = await place(page, top);
  await page.mouse.move(spot.x, spot.y);
  await page.mouse.down();
  await holding(page);
  await page.mouse.move(spot.x, spot.y - 90, {steps: 12});
  await page.waitForFunction(([id, y]) => window.caromPage.viewer.bodyPosition(id)[1] > y + 0.5, [top, before[1]]);
  await page.waitForFunction(() => /Pull of the hand(?!0 N)[1-9]/.test(document.querySelector('#budget').textContent));
  await picture(page, 'grabbed');
  await page.mouse.up();
  await page.waitForFunction(([id, y]) => window.caromPage.viewer.bodyPosition(id)[1] < y + 0.4, [top, before[1]]);
  await page.done();
});

test('a slider changes its parameter and the plot fills', async () => {
  const page = await open('collision-lab-2d');
  const slider = page.locator('#parameters input[type=range]').first();
  const number = page.locator('#parameters input[type=number]').first();
  const before = await number.inputValue();
  await slider.focus();
  for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowLeft');
  assert.notEqual(await number.inputValue(), before);
  await page.waitForSelector('#plot canvas');
  await page.done();
});

test('what has names is chosen by them, a yes or no is ticked', async () => {
  const page = await open('golf-hole');
  const first = await page.textContent('#verdict');
  await page.selectOption('#parameter-club', {label: '7-iron'});
  await page.waitForFunction((before) => { const now = document.querySelector('#verdict').textContent; return now !== '' && now !== before; }, first);
  await page.done();
  const turret = await open('hit-the-target');
  const assist = turret.locator('#parameter-assist');
  assert.ok(await assist.isChecked());
  await assist.uncheck();
  await turret.waitForFunction(() => !document.querySelector('#parameter-assist').checked);
  await turret.done();
});

test('the hovercraft is driven by keys', async () => {
  const page = await open('hovercraft');
  await page.focus('#view');
  const craft = (await bodies(page, 'dynamic'))[0], before = await place(page, craft);
  await page.keyboard.down('ArrowUp');
  await movedFrom(page, craft, before, 0.3);
  await page.keyboard.up('ArrowUp');
  await page.done();
});

test('a phone of 360 pixels shows the view, opens the menu and the panel', async () => {
  const page = await open('wrecking-ball', {viewport: {width: 360, height: 740}, hasTouch: true, isMobile: true});
  const box = await page.locator('#view').boundingBox();
  assert.ok(box.width > 350 && box.height > 400);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing sticks out');
  await page.tap('#menu');
  await page.waitForSelector('#demos', {state: 'visible'});
  await picture(page, 'phone_menu');
  const second = (await demosOf(page))[1];
  await page.tap('#demo-list a >> nth=1');
  await page.waitForFunction((demo) => window.caromPage.opened.demo === demo && window.caromPage.shown >= 0, second);
  await page.tap('#panel-toggle');
  await runFor(page, 10);
  await picture(page, 'phone_panel');
  await page.done();
});

test('a narrow window shows the bodies that a wide one shows', async () => {
  const page = await open('wrecking-ball', {viewport: {width: 1500, height: 800}});
  await page.click('#panel-toggle');
  const seen = () => page.evaluate(() => {
    const {viewer} = window.caromPage, box = document.querySelector('#view').getBoundingClientRect();
    return [...viewer.bodyIds('dynamic'), ...viewer.bodyIds('kinematic')].filter((id) => {
      const at = viewer.screenOf(id);
      return at.x > box.left && at.x < box.right && at.y > box.top && at.y < box.bottom;
    });
  });
  for (const demo of ['trebuchet', 'trajectory-lab', 'orbit_painter', 'joints', 'pyramids', 'chain', 'collision-lab-2d', 'machines', 'bridge']) {
    await page.evaluate((d) => { location.hash = `${d}?step=2`; }, demo);
    await page.waitForFunction((d) => window.caromPage.opened.demo === d && window.caromPage.shown === 2, demo);
    const wide = await seen();
    assert.ok(wide.length > 0, demo);
    await page.setViewportSize({width: 360, height: 740});
    await arranged(page);
    const lost = new Set(wide);
    for (const id of await seen()) lost.delete(id);
    assert.equal(lost.size, 0, `${demo}: ${lost.size} of ${wide.length} bodies are out of frame`);
    await page.setViewportSize({width: 1500, height: 800});
    await arranged(page);
  }
  await page.done();
});

test('who wants less motion gets a camera that stops at once', async () => {
  const page = await open('chain', {reducedMotion: 'reduce'});
  assert.equal(await page.evaluate(() => window.caromPage.viewer.controls.enableDamping), false);
  await page.done();
});

test('dark theme', async () => {
  const page = await open('wrecking-ball', {colorScheme: 'dark'});
  await beyond(page, 60);
  await picture(page, 'dark');
  await page.done();
});

test('a lost connection is said, and mended when the server is back', async () => {
  const own = await serve();
  const page = await visit(`${own.url}#wrecking-ball`);
  await page.evaluate(() => window.caromPage.send({type: 'set', name: 'angle', value: 0.5}));
  await page.waitForFunction(() => window.caromPage.share.link().parameters.angle === 0.5);
  await beyond(page, 20);
  const held = await paused(page);
  await own.close();
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /connection/);
  const again = await serve(new URL(own.url).port);
  await page.waitForSelector('#notice', {state: 'hidden'});
  await at(page, held);
  assert.equal((await page.evaluate(() => window.caromPage.share.link())).parameters.angle, 0.5, 'as it was');
  await again.close();
});

test('a demo has a page: words, formulas, symbols, what to try, where it ends, the C++ that makes it, and the scene file', async () => {
  const page = await open('rolling');
  await page.click('#lesson summary');
  await page.waitForSelector('#lesson h3:has-text("Where the model ends")');
  assert.ok(await page.locator('#lesson .formula').count() >= 2);
  assert.ok(await page.locator('#lesson .symbols dt').count() >= 4);
  await picture(page, 'lesson');
  assert.deepEqual(await barriers(page, '#about'), []);
  const read = (name) => page.evaluate((file) => fetch(file).then((answer) => answer.json()), name);
  const lessons = await read('lessons.json'), sources = await read('sources.json');
  const listed = JSON.parse(execFileSync(carom, ['list', '--json'], {maxBuffer: 1 << 28, cwd: root}));
  const texts = new Map([...listed.demos, ...listed.stress].map((d) => [d.demo, d.text]).concat(listed.scenes.map((d) => [`scene:${d.demo}`, d.text])));
  const said = [];  // what a page lacks
  for (const demo of await demosOf(page)) {
    const lesson = lessons[/^(common|box3d|box2d|jolt)-/.test(demo) ? 'stress' : demo], words = texts.get(demo) ?? '';
    const wanted = {
      words: words.length > 60, formulas: (lesson?.formulas?.length ?? 0) > 0 || words.split('\n\n').some((p) => /[=≤≥]/.test(p) && /^\s{2,}|^[^.]{0,80}=[^.]{0,120}$/.test(p)),
      symbols: Object.keys(lesson?.symbols ?? {}).length > 0, 'what to try': lesson?.try.length >= 2, 'where it ends': lesson?.ends.length > 25,
      'C++': sources[demo.startsWith('scene:') ? 'scene' : demo]?.code.length > 150,
    };
    for (const [what, is] of Object.entries(wanted)) if (!is) said.push(`${demo}: ${what}`);
  }
  assert.deepEqual(said, []);
  await page.click('text=The C++ that makes it');
  await page.waitForFunction(() => document.querySelector('.source').textContent.includes('void build(Stage3& stage)'));
  assert.ok(!(await page.textContent('.source')).includes('#include'));
  await page.click('text=The scene file');
  await page.waitForFunction(() => document.querySelector('#scene-file pre').textContent.includes('"bodies"'));
  assert.match(await page.textContent('#scene-file p'), /as it is now/);
  await page.evaluate(() => { location.hash = 'scene:pendulum'; });
  await page.waitForFunction(() => document.title.includes('endulum'));
  await page.click('text=What this shows');
  await page.waitForSelector('#lesson h3:has-text("Formulas")');
  await page.click('text=The scene file');
  await page.waitForFunction(() => document.querySelector('#scene-file pre').textContent.includes('"hinge"'));
  await picture(page, 'scene page');
  await page.done();
});
