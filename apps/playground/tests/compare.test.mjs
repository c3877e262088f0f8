// Two settings side by side: the right view keeps in step, has values of its own, and its curves beside the left one's.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {at, bodies, paused, picture, place, serve, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());

test('two settings side by side, in step', async () => {
  const page = await visit(`${server.url}#rolling`);
  await page.click('#share >> text=Compare');
  const handle = await page.waitForSelector('iframe');
  const twin = await handle.contentFrame();
  await twin.waitForFunction(() => window.caromPage?.viewer.bodyIds('dynamic').length > 0);
  // Both run; paused they are at the same step and, with the same values, at the same place.
  await page.waitForFunction(() => window.caromPage.compare.twinStep > 30);
  const same = async () => {
    const step = await paused(page);
    await twin.waitForFunction((n) => window.caromPage.shown === n, step);
  };
  await same();
  const id = (await bodies(page, 'dynamic'))[0];
  assert.deepEqual(await place(twin, id), await place(page, id));
  // A value of the right one.
  await page.click('#compare-sides >> text=B');
  const name = await page.evaluate(() => window.caromPage.opened.parameters.find((p) => p.maximum > p.value).name);
  await page.evaluate((n) => {
    const range = document.querySelector(`#parameter-${n}`);
    range.value = range.max;
    range.dispatchEvent(new Event('input'));
    range.dispatchEvent(new Event('change'));
  }, name);
  // From the beginning: this demo starts anew after four seconds, and so does the count of its steps.
  await page.click('#restart');
  await at(page, 0);
  await twin.waitForFunction(() => window.caromPage.shown === 0);
  await page.evaluate(() => window.caromPage.send({type: 'step', count: 90}));
  await at(page, 90);
  await twin.waitForFunction(() => window.caromPage.shown === 90);
  assert.notDeepEqual(await place(twin, id), await place(page, id));
  await picture(page, 'compare');
  // The panel shows the values of the side that is chosen; the left one kept its own.
  const shown = () => page.$eval(`#parameter-${name}`, (e) => Number(e.value));
  const right = await shown();
  await page.click('#compare-sides >> text=A');
  assert.notEqual(await shown(), right);
  const plotted = await page.evaluate(() => window.caromPage.plots.curves[0].map((c) => c.x.length));
  assert.ok(plotted.some((n, i) => i >= plotted.length / 2 && n > 4), `curves of the right side: ${plotted}`);
  await page.click('#share >> text=Compare');
  assert.equal(await page.$('iframe'), null);
  await page.done();
});
