// What leaves the page and comes into it: links, recordings, scene files, plots as tables.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, before, test} from 'node:test';
import {at, beyond, bodies, carom, paused, picture, place, root, serve, slide, until, visit} from './harness.mjs';

let server;
const folder = mkdtempSync(join(tmpdir(), 'carom-page-'));
before(async () => { server = await serve(); });
after(() => { server?.close(); rmSync(folder, {recursive: true}); });
const open = (link) => visit(`${server.url}#${link}`);
const give = (page, ...files) => page.setInputFiles('#share input[type=file]', files);

test('a link restores demo, parameters, moment and view', async () => {
  const page = await open('wrecking-ball?angle=0.6&step=90&camera=12,5,9,0,2,0');
  await at(page, 90);
  await until(page, 'Run');
  const link = await page.evaluate(() => window.caromPage.share.link());
  assert.equal(link.parameters.angle, 0.6);
  link.camera.forEach((x, i) => assert.ok(Math.abs(x - [12, 5, 9, 0, 2, 0][i]) < 1e-3, `camera ${link.camera}`));
  const ball = (await bodies(page, 'dynamic')).at(-1), there = await place(page, ball);
  const again = await open(`wrecking-ball?angle=0.6&step=90`);
  await at(again, 90);
  assert.deepEqual(await place(again, ball), there);
  await page.done();
});

test('a thrust file becomes rockets, and one with an error is named by its line', async () => {
  const page = await open('chain');
  await paused(page);
  await give(page, join(root, 'presets/motor/black_powder.eng'));
  await page.waitForFunction(() => document.title.includes('black_powder.eng flies'));
  for (const name of ['A8', 'B6', 'C6', 'D12']) assert.ok(await page.evaluate((name) => window.caromPage.share.scene.text.includes(`"rocket.${name}.thrust"`), name), name);
  await picture(page, 'motor file');
  const bad = join(folder, 'bad.eng');
  writeFileSync(bad, '; mine\nM1 18 70 3 0.005 0.02 me\n0.1 5\n0.05 4\n0.2 0\n');
  await give(page, bad);
  await page.waitForFunction(() => /bad\.eng:4: found the time 0\.05, expected times that rise from 0/.test(document.querySelector('#notice').textContent));
  assert.match(await page.title(), /black_powder/, 'what was open stays');
  await page.done();
});

test('a recording is made, saved, opened again and scrubbed', async () => {
  const page = await open('chain');
  const start = await paused(page);
  await page.click('#share button:has-text("Record")');
  await page.waitForSelector('#share button:has-text("Save recording")');
  await page.evaluate(() => window.caromPage.send({type: 'step', count: 60}));
  await at(page, start + 60);
  const ids = await bodies(page, 'dynamic'), end = await place(page, ids.at(-1));
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click('#share button:has-text("Save recording")')]);
  const file = join(folder, 'chain.carom-rec');
  await saved.saveAs(file);
  await page.evaluate(() => { location.hash = 'pyramids'; });
  await page.waitForFunction(() => document.title.includes('pyramids'));
  await give(page, file);
  await page.waitForFunction(() => document.title.includes('Chain'));
  await page.waitForFunction(() => document.querySelector('#verdict').textContent === 'recording');
  await slide(page, start + 60);
  await at(page, start + 60);
  const shown = await place(page, ids.at(-1));
  shown.forEach((x, i) => assert.ok(Math.abs(x - end[i]) < 1e-5, `${shown} instead of ${end}`));
  await slide(page, start + 10);
  await at(page, start + 10);
  await picture(page, 'recording');
  // Run again from what opened it: the same poses and hashes at every step.
  await page.click('#share button:has-text("Check recording")');
  await page.waitForFunction(() => /^Run again: /.test(document.querySelector('#notice').textContent) && /equal|same|agree/.test(document.querySelector('#notice').textContent));
  await picture(page, 'checked recording');
  await page.done();
});

test('a recording of 30 MB opens and is scrubbed; a broken one is named', async () => {
  execFileSync(carom, ['run', 'heap', '--set', 'layers=25', '--steps', '500', '--no-pictures', '--quiet', '--out', folder], {cwd: root});
  const file = join(folder, 'recording.carom-rec');
  assert.ok(statSync(file).size > 25e6, `${statSync(file).size} bytes`);
  const page = await open('chain');
  await give(page, file);
  // Its name comes first, its bodies and its length after that.
  await page.waitForFunction(() => document.title.includes('Heap') && document.querySelector('#past').max === '500');
  for (const step of [480, 20, 250]) {
    await slide(page, step);
    await at(page, step);
  }
  await picture(page, 'large recording');
  const bytes = readFileSync(file).subarray(0, 5000);
  bytes[100] ^= 1;
  writeFileSync(join(folder, 'broken.carom-rec'), bytes);
  await give(page, join(folder, 'broken.carom-rec'));
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /recording/);
  assert.match(await page.title(), /Heap/, 'what was open stays open');
  await page.done();
});

test('a scene file opens, and a wrong one is shown at its line', async () => {
  const page = await open('chain');
  const scene = {name: 'Two balls', dimension: 3, bodies: [{name: 'ball', position: [0, '2 m', 0], shape: {type: 'sphere', radius: '0.5 m'}}]};
  writeFileSync(join(folder, 'good.json'), JSON.stringify(scene, null, 1));
  await give(page, join(folder, 'good.json'));
  await page.waitForFunction(() => document.title.includes('Two balls'));
  writeFileSync(join(folder, 'bad.json'), '{\n "name": "bad", "dimension": 3,\n "bodies": [\n  {"masss": "3 kg"}\n ]\n}');
  await give(page, join(folder, 'bad.json'));
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.textContent('#notice'), /bad\.json:4:.*masss[^]*4 │ \{"masss": "3 kg"\}/);
  await picture(page, 'wrong scene');
  assert.match(await page.title(), /Two balls/);
  await page.done();
});

test('a scene is dropped on the page; what the view shows is saved as a picture', async () => {
  const page = await open('chain');
  const scene = {name: 'Dropped', dimension: 3, bodies: [{name: 'ball', position: [0, '2 m', 0], shape: {type: 'sphere', radius: '0.5 m'}}]};
  await page.evaluate((text) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], 'dropped.json'));
    for (const type of ['dragover', 'drop']) document.querySelector('#view').dispatchEvent(new DragEvent(type, {dataTransfer, bubbles: true, cancelable: true}));
  }, JSON.stringify(scene));
  await page.waitForFunction(() => document.title.includes('Dropped') && window.caromPage.viewer.bodyIds('dynamic').length === 1);
  const [png] = await Promise.all([page.waitForEvent('download'), page.click('#share button:has-text("Picture")')]);
  await png.saveAs(join(folder, 'view.png'));
  const bytes = readFileSync(join(folder, 'view.png'));
  assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
  assert.ok(bytes.readUInt32BE(16) > 300 && bytes.length > 8000, `${bytes.readUInt32BE(16)} pixels wide, ${bytes.length} bytes`);
  await page.done();
});

test('a running game is attached to: its bodies are pulled, it is paused and stepped', async () => {
  const game = spawn(join(dirname(carom), '../../examples/example_debugged_game'), ['0'], {stdio: ['ignore', 'pipe', 'pipe']});
  try {
    const url = await new Promise((resolve, reject) => {
      let text = '';
      for (const out of [game.stdout, game.stderr]) out.on('data', (bytes) => {
        text += bytes;
        const match = text.match(/http:\/\/[\w.:[\]]+\//);
        if (match) resolve(match[0]);
      });
      game.on('error', reject).on('exit', (code) => reject(new Error(`the game ended with ${code}: ${text}`)));
    });
    const page = await visit(url);
    await page.waitForFunction(() => document.title.includes('Eight balls') && window.caromPage.viewer.bodyIds('dynamic').length === 8);
    await beyond(page, 5);
    const held = await paused(page);
    await page.click('#step');
    await at(page, held + 1);
    await page.evaluate((id) => window.caromPage.choose(id), (await bodies(page, 'dynamic'))[0]);
    await page.waitForSelector('#why-section:not([hidden])');
    await picture(page, 'game');
    assert.ok(await page.isHidden('#restart'), 'a game keeps its own time');
    await page.done();
  } finally {
    game.kill();
  }
});

test('a plot is saved as a table and as a picture, and read at the cursor', async () => {
  const page = await open('chain?step=60');
  await at(page, 60);
  const [csv] = await Promise.all([page.waitForEvent('download'), page.click('#plot-csv')]);
  await csv.saveAs(join(folder, 'plot.csv'));
  const rows = readFileSync(join(folder, 'plot.csv'), 'utf8').trim().split('\r\n');
  assert.match(rows[0], /time \(s\)/);
  assert.ok(rows.length > 30 && rows.slice(1).every((row) => /^"[^"]+",[-\d.e]+,[-\d.e]+$/.test(row)), rows[1]);
  const [png] = await Promise.all([page.waitForEvent('download'), page.click('#plot-png')]);
  await png.saveAs(join(folder, 'plot.png'));
  assert.equal(readFileSync(join(folder, 'plot.png')).subarray(1, 4).toString(), 'PNG');
  const box = await page.locator('#plot .u-over').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction(() => /time [\d.]+ s: chain/.test(document.querySelector('#plot-value').textContent));
  // Zoom: drag over a part, double click for the whole.
  const range = () => page.evaluate(() => window.caromPage.plots.chart.scales.x.max - window.caromPage.plots.chart.scales.x.min);
  const whole = await range();
  await page.mouse.down();
  await page.mouse.move(box.x + 0.75 * box.width, box.y + 0.8 * box.height, {steps: 4});
  await page.mouse.up();
  await page.waitForFunction((w) => window.caromPage.plots.chart.scales.x.max - window.caromPage.plots.chart.scales.x.min < 0.6 * w, whole);
  await page.mouse.dblclick(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction((w) => window.caromPage.plots.chart.scales.x.max - window.caromPage.plots.chart.scales.x.min > 0.9 * w, whole);
  await page.done();
});

test('a histogram keeps one point a place', async () => {
  const page = await open('hail-on-pegs?step=600');
  await at(page, 600);
  const {x, y} = await page.evaluate(() => window.caromPage.plots.curves[0][1]);
  assert.deepEqual(x.map((place) => place / 0.25).sort((a, b) => a - b), [-4, -3, -2, -1, 0, 1, 2, 3, 4]);
  assert.ok(Math.abs(y.reduce((sum, share) => sum + share, 0) - 1) < 0.05, `shares ${y}`);
  await picture(page, 'hail-on-pegs');
  await page.done();
});
