// Pictures of a few demos at a fixed step beside what they were when they were last looked at (pictures.json: 32 by 20
// coarse pixels each). PICTURES_UPDATE=1 writes them anew; then look at the files in PICTURES.
import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {after, before, test} from 'node:test';
import {drawn, picture, serve, visit} from './harness.mjs';

const file = new URL('pictures.json', import.meta.url), update = process.env.PICTURES_UPDATE === '1';
const kept = JSON.parse(readFileSync(file, 'utf8'));
const MEAN = 4, MOST = 160;  // of 255: how far coarse pixels may differ on average, and one of them (a limb that moved)

let server;
before(async () => { server = await serve(); });
after(() => server?.close());

test('pictures are what they were when they were looked at', async () => {
  const page = await visit(`${server.url}#chain`, {viewport: {width: 960, height: 640}, colorScheme: 'light'});
  await page.click('#panel-toggle');
  await page.evaluate(() => { window.caromPage.viewer.nextChange = Infinity; });  // as fine on a slow machine as on a fast one
  for (const demo of ['wrecking-ball', 'joints', 'hovercraft', 'fluid-tank', 'flag-and-sail', 'orbit_painter', 'trajectory-lab', 'drop-fountain']) {
    await page.evaluate((d) => { location.hash = `${d}?step=60`; }, demo);
    await page.waitForFunction((d) => window.caromPage.opened.demo === d && window.caromPage.shown === 60 && !window.caromPage.running, demo);
    await drawn(page);
    const found = await page.evaluate(async () => {
      const view = await createImageBitmap(await window.caromPage.viewer.picture());
      // Halved until it is small: every pixel counts.
      let canvas = new OffscreenCanvas(1024, 640);
      canvas.getContext('2d').drawImage(view, 0, 0, 1024, 640);
      for (let width = 512; width >= 32; width /= 2) {
        const half = new OffscreenCanvas(width, width * 0.625);
        half.getContext('2d').drawImage(canvas, 0, 0, half.width, half.height);
        canvas = half;
      }
      const {data} = canvas.getContext('2d').getImageData(0, 0, 32, 20);
      return [...data].filter((_, i) => i % 4 < 3);
    });
    await picture(page, `kept ${demo}`);
    if (update) { kept[demo] = Buffer.from(found).toString('base64'); continue; }
    const wanted = Buffer.from(kept[demo], 'base64'), off = found.map((x, i) => Math.abs(x - wanted[i]));
    const mean = off.reduce((sum, x) => sum + x, 0) / off.length, most = Math.max(...off);
    assert.ok(mean <= MEAN && most <= MOST, `${demo}: coarse pixels differ by ${mean.toFixed(1)} on average and ${most} at most`);
  }
  if (update) writeFileSync(file, JSON.stringify(kept, null, 1));
  await page.done();
});
