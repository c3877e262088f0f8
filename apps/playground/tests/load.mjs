// What a page full of bodies costs: bytes on the socket, milliseconds of script by the browser's own profiler (drawing
// apart: there is no GPU here), and how long until something is seen. Times are the best of a few tries, because a busy
// machine only ever adds to them.
import assert from 'node:assert/strict';
import {after, before, test} from 'node:test';
import {beyond, paused, picture, runFor, serve, visit} from './harness.mjs';

let server;
before(async () => { server = await serve(); });
after(() => server?.close());

/**
 * Milliseconds for a fixed piece of work of the kind that a page's load is: an empty page asks for WebGL, has a shader
 * compiled and draws with it. On a quiet machine of the kind of the tables in docs/benchmarks.md: REFERENCE.
 */
const REFERENCE = 300;
async function reference() {
  const page = await visit('about:blank', {sparing: false}, false);
  const taken = await page.evaluate(() => {
    const began = performance.now(), gl = document.createElement('canvas').getContext('webgl2'), program = gl.createProgram();
    const steps = Array.from({length: 60}, (_, i) => `p = fract(p * ${(1 + 0.01 * i).toFixed(2)} + sin(p.yzx + float(${i}))); if (p.x > 0.${i + 10}) p = normalize(p + cross(p, p.zxy));`).join('\n');
    for (const [type, text] of [[gl.VERTEX_SHADER, '#version 300 es\nvoid main() { gl_Position = vec4(0.0, 0.0, 0.0, 1.0); gl_PointSize = 1.0; }'],
      [gl.FRAGMENT_SHADER, `#version 300 es\nprecision highp float;\nout vec4 color;\nvoid main() {\nvec3 p = gl_FragCoord.xyz;\n${steps}\ncolor = vec4(p, 1.0);\n}`]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.drawArrays(gl.POINTS, 0, 1);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    return performance.now() - began;
  });
  await page.context().close();
  return taken;
}

test('the first picture comes within 2 s of the page\'s load', async () => {
  // Neighbours can make a machine twice as slow for minutes: then the bar is that much higher.
  let best = Infinity, fixed = Infinity, bar = 2000;
  for (let i = 0; i < 3 || i < 8 && best > bar; ++i) {  // the first try has a cold browser
    fixed = Math.min(fixed, await reference());
    bar = 2000 * Math.max(1, fixed / REFERENCE);
    const page = await visit(`${server.url}#wrecking-ball`, {sparing: false});
    await page.waitForFunction(() => window.caromPage.firstPicture > 0);
    best = Math.min(best, await page.evaluate(() => window.caromPage.firstPicture));
    await page.done();
    await page.context().close();  // a page left open goes on drawing and slows the next try
  }
  assert.ok(best > 0 && best <= bar, `${best} ms, where ${bar.toFixed(0)} may be`);
  console.log(`first picture after ${best.toFixed(0)} ms; the reference work took ${fixed.toFixed(0)}`);
});

/** So many balls that fly without weight in a box, each far enough from the next that few meet. */
function swarm(count) {
  const side = Math.ceil(Math.cbrt(count)), bodies = [], noise = (i) => Math.sin(12.9898 * i) * 2 % 1;
  for (let i = 0; i < count; ++i) {
    const at = [i % side, Math.floor(i / side) % side, Math.floor(i / side / side)].map((k) => 2 * (k - side / 2));
    bodies.push({position: at, velocity: [noise(3 * i), noise(3 * i + 1), noise(3 * i + 2)].map((v) => 0.6 * v), angular_velocity: [0, 1 + noise(i), 0], sleep_speed: 0, shape: {type: i % 2 ? 'sphere' : 'box', ...(i % 2 ? {radius: '0.3 m'} : {size: [0.4, 0.4, 0.4]})}});
  }
  return {name: `Swarm of ${count}`, dimension: 3, gravity: [0, 0, 0], duration: '60 s', camera: {position: [1.4 * side, 1.2 * side, 2.6 * side], target: [0, 0, 0]}, bodies};
}

async function open(count) {
  const page = await visit(`${server.url}#chain`, {sparing: false});
  await page.evaluate(({name, text}) => {
    window.caromPage.send({type: 'open_scene', name, text});
    // What the socket carries, and how often.
    window.traffic = {bytes: 0, frames: 0};
    window.caromPage.source.socket.addEventListener('message', ({data}) => {
      window.traffic.bytes += data.byteLength ?? data.length;
      if (data.byteLength && new Uint8Array(data)[0] === 2) ++window.traffic.frames;
    });
  }, {name: 'swarm.json', text: JSON.stringify(swarm(count))});
  await page.waitForFunction((n) => document.title.includes(`Swarm of ${n}`) && window.caromPage.viewer.bodyIds('dynamic').length === n, count);
  await beyond(page, 10);
  return page;
}

/** Over some seconds of running: bytes a frame on the socket, and ms of script a frame. */
async function cost(page, seconds) {
  const client = await page.context().newCDPSession(page);
  await client.send('Profiler.enable');
  await client.send('Profiler.setSamplingInterval', {interval: 200});
  await page.evaluate(() => { window.traffic.bytes = window.traffic.frames = 0; window.since = performance.now(); });
  await client.send('Profiler.start');
  await page.waitForFunction((ms) => performance.now() - window.since > ms && window.traffic.frames > 20, 1000 * seconds, {polling: 200});
  const {profile} = await client.send('Profiler.stop');
  const seen = await page.evaluate(() => ({...window.traffic, seconds: (performance.now() - window.since) / 1000}));
  const names = new Map(profile.nodes.map((node) => [node.id, node.callFrame.functionName]));
  const busy = profile.samples.reduce((sum, id, i) => sum + (['(idle)', '(program)', '(root)'].includes(names.get(id)) ? 0 : profile.timeDeltas[i] / 1000), 0);
  return {bytes: seen.bytes / seen.frames, rate: seen.frames / seen.seconds, script: busy / seen.frames};
}
/** From here on nothing is drawn: what the page itself does remains. */
const withoutDrawing = (page) => page.evaluate(() => { window.caromPage.viewer.renderer.render = () => {}; });

test('2 000 moving bodies: at most 4 MB/s at 60 updates a second, under 6 ms of script a frame', async () => {
  const page = await open(2000);
  await runFor(page, 10);
  await picture(page, 'load 2000');
  await withoutDrawing(page);
  let best;
  for (let i = 0; i < 4 && !(best?.script < 6); ++i) {
    const found = await cost(page, 2.5);
    assert.ok(60 * found.bytes <= 4e6, `${60 * found.bytes / 1e6} MB/s`);
    if (!best || found.script < best.script) best = found;
  }
  console.log(`2 000 bodies: ${(60 * best.bytes / 1e6).toFixed(2)} MB/s at 60 updates a second (here ${best.rate.toFixed(0)}), ${best.script.toFixed(2)} ms of script a frame`);
  assert.ok(60 * best.bytes > 2000 * 24 * 60 * 0.9, 'all of them move');
  assert.ok(best.script < 6, `${best.script} ms of script a frame`);
  await page.done();
});

test('10 000 bodies stay usable', async () => {
  const page = await open(10000);
  await picture(page, 'load 10000');
  // The run is paused, stepped and turned on again with all of them in the picture.
  await paused(page);
  await page.click('#step');
  await page.click('#run');
  await runFor(page, 3);
  await withoutDrawing(page);
  let best;
  for (let i = 0; i < 4 && !(best?.script < 16); ++i) {
    const found = await cost(page, 2.5);
    if (!best || found.script < best.script) best = found;
  }
  console.log(`10 000 bodies: ${best.script.toFixed(2)} ms of script a frame, ${best.rate.toFixed(0)} updates a second`);
  assert.ok(best.script < 16, `${best.script} ms of script a frame`);
  await page.done();
});
