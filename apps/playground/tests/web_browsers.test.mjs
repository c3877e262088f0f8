// The page without a server of ours in Firefox and in WebKitGTK, the engine of Safari, where they are installed: the same
// bits as natively, on one thread and on several, a body pulled by the mouse, plots, and no word of complaint.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {drive, lacks} from './drivers.mjs';
import {carom, ISOLATED, pictures, root, serveFolder} from './harness.mjs';

const web = process.env.WEB ?? join(root, 'out/web'), scratch = mkdtempSync(join(tmpdir(), 'carom-browsers-'));
const DEMO = 'wrecking-ball', STEPS = 150;  // the ball has struck the wall
let server, isolated, native;
before(async () => {
  server = await serveFolder(web);
  isolated = await serveFolder(web, ISOLATED);
  native = JSON.parse(execFileSync(carom, ['run', DEMO, '--steps', String(STEPS), '--json', '--no-record', '--no-pictures', '--out', scratch], {cwd: root})).state_hash;
});
after(() => { server?.close(); isolated?.close(); rmSync(scratch, {recursive: true, force: true}); });

/** The state hash of the run at its step, and on how many threads it was made. */
const atStep = (step) => {
  const numbers = document.querySelector('#numbers'), rows = [...numbers.querySelectorAll('dd')];
  return numbers.dataset.step === String(step) && {hash: rows[rows.length - 1].textContent, threads: Number(numbers.textContent.match(/on (\d+) thread/)[1])};
};

async function withBrowser(name, environment, act) {
  const browser = await drive(name, environment);
  try {
    await browser.size(1200, 850);
    await act(browser);
  } catch (error) {
    await browser.picture(join(pictures, `${name}_failed.png`)).catch(() => {});
    throw error;
  } finally {
    await browser.close();
  }
}
const options = (name) => ({skip: lacks[name] ? `not installed: ${lacks[name]}` : false, timeout: 600e3});

async function works(browser, name) {
  await browser.open(`${server.url}#${DEMO}?step=${STEPS}`);
  assert.deepEqual(await browser.until(atStep, STEPS), {hash: native, threads: 1});
  assert.equal(await browser.evaluate(() => document.querySelector('#notice').textContent), '');
  // The plot has its curves.
  await browser.until(() => { const c = document.querySelector('#plot canvas'); return c && new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size > 8; });
  await browser.picture(join(pictures, `${name}.png`));
  // The ball is pulled up by the mouse.
  const at = await browser.evaluate(() => window.caromPage.viewer.screenOf(window.caromPage.viewer.bodyIds('dynamic').at(-1)));
  await browser.press(at.x, at.y);
  await browser.until(() => [...window.caromPage.hands.holds.values()].some((h) => h.held));
  await browser.evaluate(() => document.querySelector('#run').click());
  await browser.drag(at.x, at.y - 60);
  await browser.until(() => /Pull of the hand(?!0 N)[1-9]/.test(document.querySelector('#budget').textContent));
  await browser.picture(join(pictures, `${name}_pull.png`));
  await browser.release();
  await browser.until(() => window.caromPage.hands.holds.size === 0);
}

/** Where the server isolates the page and the browser shares memory: several threads, and the same. */
async function worksIsolated(browser, shares) {
  await browser.open(`${isolated.url}#${DEMO}?step=${STEPS}`);
  const found = await browser.until(atStep, STEPS);
  const {isolation, memory, processors} = await browser.evaluate(() => ({isolation: crossOriginIsolated, memory: typeof SharedArrayBuffer === 'function', processors: navigator.hardwareConcurrency}));
  assert.ok(isolation && memory === shares);
  assert.deepEqual(found, {hash: native, threads: shares ? Math.min(8, processors) : 1});
}

test('Firefox', options('Firefox'), () => withBrowser('Firefox', {}, async (browser) => {
  await works(browser, 'Firefox');
  await worksIsolated(browser, true);
}));
// A system without a language, as containers have it, WebKit hands on to the page. Safari shares memory, WebKitGTK only when it is told to.
test('WebKit', options('WebKit'), () => withBrowser('WebKit', {LC_ALL: 'C'}, async (browser) => {
  await works(browser, 'WebKit');
  await worksIsolated(browser, false);
}));
test('WebKit with shared memory', options('WebKit'), () => withBrowser('WebKit', {JSC_useSharedArrayBuffer: '1'}, (browser) => worksIsolated(browser, true)));
