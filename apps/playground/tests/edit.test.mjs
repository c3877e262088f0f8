// The scene editor: edits act at once, errors stand at their lines, the schema completes.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {barriers, bodies, picture, place, serve, until, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());

const text = (page) => page.evaluate(() => window.caromPage.editing.editor.text);
const write = (page, value) => page.evaluate((t) => {
  const view = window.caromPage.editing.editor.view;
  view.dispatch({changes: {from: 0, to: view.state.doc.length, insert: t}});
}, value);
const status = (page, what) => page.waitForFunction((t) => document.querySelector('#edit-status').textContent.includes(t), what);

test('a scene file is edited beside the view', async () => {
  const page = await visit(`${server.url}#scene:pendulum`);
  await page.waitForFunction(() => document.title.includes('endulum'));
  await page.click('#run');
  await until(page, 'Run');
  await page.keyboard.press('e');
  await page.waitForFunction(() => window.caromPage.editing.editor?.text.includes('"bodies"'));
  const scene = JSON.parse(await text(page)), count = (await bodies(page, 'dynamic')).length;
  // One body more, at once, and still paused.
  scene.bodies.push({name: 'added', position: ['3 m', '4 m', '0 m'].slice(0, scene.dimension ?? 3), shape: {type: scene.dimension === 2 ? 'circle' : 'sphere', radius: '0.2 m'}});
  await write(page, JSON.stringify(scene, null, 2));
  await status(page, 'runs');
  await page.waitForFunction((n) => window.caromPage.viewer.bodyIds('dynamic').length === n, count + 1);
  await until(page, 'Run');
  // A mistake leaves the running scene alone and is named at its line.
  scene.bodies.at(-1).shape.radius = '0.2 kg';
  const wrong = JSON.stringify(scene, null, 2), line = wrong.split('\n').findIndex((l) => l.includes('0.2 kg')) + 1;
  await write(page, wrong);
  await status(page, `line ${line}:`);
  assert.equal((await bodies(page, 'dynamic')).length, count + 1);
  for (const go of [() => page.click('#edit-status'), () => page.press('#edit-status', 'Enter')]) {  // both go to the line
    await page.evaluate(() => window.caromPage.editing.editor.view.dispatch({selection: {anchor: 0}}));
    await go();
    await page.waitForFunction((n) => { const {state, hasFocus} = window.caromPage.editing.editor.view; return hasFocus && state.doc.lineAt(state.selection.main.head).number === n; }, line);
  }
  await page.waitForSelector('.cm-lint-marker-error');
  await picture(page, 'editor');
  await write(page, '{ "bodies": [ ');
  await page.waitForFunction(() => document.querySelector('#edit-status').classList.contains('wrong'));
  await page.done();
});

test('a demo becomes a scene, and the schema completes keys and values of a new one', async () => {
  const page = await visit(`${server.url}#pyramids`);
  await page.keyboard.press('e');
  // A demo that a program makes: its world as it is now, which an edit makes a scene of.
  await page.waitForFunction(() => window.caromPage.editing.editor?.text.includes('"bodies"'));
  await status(page, 'as it is now');
  const count = (await bodies(page, 'dynamic')).length, world = JSON.parse(await text(page));
  assert.equal(world.bodies.filter((b) => (b.type ?? 'dynamic') === 'dynamic').length, count);
  world.bodies.splice(world.bodies.findIndex((b) => (b.type ?? 'dynamic') === 'dynamic'), 1);
  await write(page, JSON.stringify(world));
  await status(page, 'runs');
  await page.waitForFunction((n) => window.caromPage.viewer.bodyIds('dynamic').length === n, count - 1);
  await page.click('#edit-new');
  await page.waitForFunction(() => window.caromPage.editing.editor?.text.includes('crate'));
  await page.waitForFunction(() => document.title.includes('mine') || window.caromPage.viewer.bodyIds('dynamic').length === 1);
  const complete = async (before, behind) => {
    await page.evaluate(([a, b]) => {
      const view = window.caromPage.editing.editor.view;
      view.dispatch({changes: {from: 0, to: view.state.doc.length, insert: a + b}, selection: {anchor: a.length}});
      view.focus();
    }, [before, behind]);
    await page.keyboard.press('Control+Space');
    await page.waitForSelector('.cm-tooltip-autocomplete');
    const labels = await page.$$eval('.cm-tooltip-autocomplete .cm-completionLabel', (all) => all.map((e) => e.textContent));
    await page.keyboard.press('Escape');
    return labels;
  };
  const keys = await complete('{"bodies": [{"name": "a", "shape": {"type": "box", ', '}}]}');
  assert.ok(keys.includes('"size"') && keys.includes('"material"'), keys.join(' '));
  assert.ok(!keys.includes('"type"'), 'what is there is not offered again');
  const values = await complete('{"bodies": [{"shape": {"type": ', '}}]}');
  assert.ok(values.includes('"sphere"') && values.includes('"ellipsoid"'), values.join(' '));
  const top = await complete('{', '}');
  assert.ok(top.includes('"bodies"') && top.includes('"gravity"'), top.join(' '));
  // Open to all with a message that is longer than its place, too.
  await write(page, `{"bodies": [{"shape": {"type": "${'sphere or box or '.repeat(30)}"}}]}`);
  await page.waitForFunction(() => { const {scrollHeight, clientHeight} = document.querySelector('#edit-status.wrong') ?? {}; return scrollHeight > clientHeight; });
  assert.deepEqual(await barriers(page, '#editor'), []);
  await page.keyboard.press('Escape');
  await page.click('#edit-close');
  assert.ok(await page.isHidden('#editor'));
  await page.done();
});

test('what is typed restarts the scene and keeps the view', async () => {
  const page = await visit(`${server.url}#scene:pendulum`);
  await page.keyboard.press('e');
  await page.waitForFunction(() => window.caromPage.editing.editor?.text.includes('"bodies"'));
  const changed = (await text(page)).replace(/"name": "[^"]*"/, '"name": "other"');
  await write(page, changed);
  await status(page, 'runs');
  const view = await page.evaluate(() => { window.caromPage.viewer.viewpoint = [3, 3, 9, 0, 1, 0]; return window.caromPage.viewer.viewpoint; });
  await write(page, changed.replace('"other"', '"another"'));
  await page.waitForFunction(() => document.title.includes('another'));
  await page.waitForFunction(() => window.caromPage.shown >= 0);
  assert.deepEqual((await page.evaluate(() => window.caromPage.viewer.viewpoint)).map((x) => x.toFixed(3)), view.map((x) => x.toFixed(3)));
  assert.ok(await place(page, (await bodies(page, 'dynamic'))[0]));
  await page.done();
});
