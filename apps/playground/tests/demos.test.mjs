// Every demo once, in one page: it opens, runs, shows its numbers, says what it shows, and is accessible. PICTURES keeps
// what each looked like.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {barriers, beyond, demosOf, drawn, picture, serve, visit} from './harness.mjs';

const DIFFERS = ['header', '#stage', '#about', '#plot-choice', '#plot', '#parameters', '#numbers', '#budget'];

/** What stands in these parts, by what axe goes by: elements, classes, attributes, colours of their own, whether there is text; not which words. */
const kinds = (page, parts) => page.evaluate((within) => {
  const worded = /^(id|for|name|href|src|title|value|min|max|step|data-.*|aria-(label|labelledby|describedby|valuetext|controls))$/;
  const kind = (e) => `${e.localName}.${e.className}[${[...e.attributes].map((a) => (worded.test(a.name) ? `${a.name}:${a.value !== ''}` : `${a.name}=${a.value}`)).join()}]${[...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim() !== '')}`;
  const path = (e) => (e === document.body ? '' : `${path(e.parentElement)} ${kind(e)}`);
  return [...new Set(within.flatMap((part) => [...document.querySelectorAll(`${part}, ${part} *`)]).map(path))];
}, parts);

let server;
before(async () => { server = await serve(); });
after(() => server?.close());

test('every demo opens, moves or stands, shows its numbers, and is accessible', async () => {
  const page = await visit(`${server.url}#wrecking-ball`, {viewport: {width: 840, height: 560}});
  // All is drawn as ever, of few pixels where nobody keeps the pictures.
  if (!process.env.PICTURES) await page.evaluate(() => {
    const {viewer} = window.caromPage, {shadow} = viewer.sun;
    viewer.renderer.setPixelRatio(0.25);
    shadow.mapSize.set(128, 128);
    shadow.map?.dispose();
    shadow.map = null;
    viewer.resize();
  });
  const demos = await demosOf(page), seen = new Set();
  let asked = 0;
  for (const demo of demos) {
    await page.evaluate((d) => { location.hash = d; }, demo);
    await page.waitForFunction((d) => document.querySelector('#demo-list a[aria-current]')?.dataset.demo === d, demo);
    await beyond(page, 5);
    await page.evaluate(() => window.caromPage.send({type: 'pause'}));  // what is drawn on and on would share the processor
    await (process.env.PICTURES ? picture(page, demo) : drawn(page));
    assert.notEqual(await page.textContent('#numbers'), '', demo);
    assert.ok((await page.textContent('#about .summary')).length > 25, `${demo} says what it shows`);
    // All of the page once; then what differs from demo to demo, where there is anything of a kind that was not there before.
    const fresh = (await kinds(page, DIFFERS)).filter((kind) => !seen.has(kind));
    fresh.forEach((kind) => seen.add(kind));
    if (fresh.length > 0) { ++asked; assert.deepEqual(await barriers(page, demo === demos[0] ? undefined : {include: DIFFERS}), [], demo); }
  }
  console.log(`${asked} of ${demos.length} demos have something new for axe`);
  await page.done();
});
