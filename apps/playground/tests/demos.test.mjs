// Every demo once, in one page: it opens, runs, shows its numbers, says what it shows, and is accessible. PICTURES keeps
// what each looked like.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {barriers, beyond, demosOf, picture, serve, visit} from './harness.mjs';

const DIFFERS = ['header', '#stage', '#about', '#plot-choice', '#plot', '#parameters', '#numbers', '#budget'];

let server;
before(async () => { server = await serve(); });
after(() => server?.close());

test('every demo opens, moves or stands, shows its numbers, and is accessible', async () => {
  const page = await visit(`${server.url}#wrecking-ball`, {pause: 1e9, viewport: {width: 840, height: 560}});
  const demos = await demosOf(page);
  for (const demo of demos) {
    await page.evaluate((d) => { location.hash = d; }, demo);
    await page.waitForFunction((d) => document.querySelector('#demo-list a[aria-current]')?.dataset.demo === d, demo);
    await beyond(page, 5);
    await picture(page, demo);
    await page.evaluate(() => window.caromPage.send({type: 'pause'}));  // what follows needs no picture
    assert.notEqual(await page.textContent('#numbers'), '', demo);
    assert.ok((await page.textContent('#about .summary')).length > 25, `${demo} says what it shows`);
    // All of the page once; then what differs from demo to demo.
    assert.deepEqual(await barriers(page, demo === demos[0] ? undefined : {include: DIFFERS}), [], demo);
  }
  await page.done();
});
