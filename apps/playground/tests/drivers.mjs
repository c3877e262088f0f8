// Browsers other than Chromium, where they are installed, by the interfaces that they have of themselves: Firefox by
// Marionette, WebKitGTK (the engine of Safari) by its WebDriver on a screen that nobody sees.
import {spawn} from 'node:child_process';
import {existsSync, mkdtempSync, rmSync, writeFileSync} from 'node:fs';
import {connect, createServer} from 'node:net';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {PATIENCE} from './harness.mjs';

const inPath = (name) => process.env.PATH.split(':').map((folder) => join(folder, name)).find(existsSync);
const miniBrowser = ['/usr/lib/x86_64-linux-gnu', '/usr/lib/aarch64-linux-gnu', '/usr/libexec', '/usr/lib'].flatMap((f) => ['4.1', '6.0', '4.0'].map((v) => join(f, `webkit2gtk-${v}/MiniBrowser`))).find(existsSync);
const firefox = inPath('firefox-esr') ?? inPath('firefox');

const missing = (browser, ...programs) => [...(browser ? [] : ['the browser']), ...programs.filter((name) => !inPath(name))].join(', ');

/** What is missing for a browser to be driven; empty where nothing is. */
export const lacks = {
  Firefox: missing(firefox, 'Xvfb'),
  WebKit: missing(miniBrowser, 'WebKitWebDriver', 'Xvfb', 'dbus-run-session'),
};

const freePort = () => new Promise((resolve) => {
  const probe = createServer().listen(0, '127.0.0.1', () => { const {port} = probe.address(); probe.close(() => resolve(port)); });
});
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** A program in a process group of its own, so that it ends with all that it has started. */
function start(program, args, env, signal = 'SIGKILL') {
  const child = spawn(program, args, {stdio: 'ignore', detached: true, env: {...process.env, ...env}});
  child.on('error', () => {});
  return () => new Promise((resolve) => {
    if (child.exitCode !== null || child.pid === undefined) { resolve(); return; }
    child.on('exit', resolve);
    process.kill(-child.pid, signal);
  });
}

function screen() {
  const display = `:${90 + process.pid % 9000}`;
  return {display, close: start('Xvfb', [display, '-screen', '0', '1280x900x24', '-nolisten', 'tcp'], {}, 'SIGTERM')};  // it takes its lock away as it ends
}

/** Firefox: `call(command, values)` over Marionette's socket, `[0, id, command, values]` answered by `[1, id, error, result]`. */
async function openFirefox(folder) {
  const port = await freePort();
  writeFileSync(join(folder, 'user.js'), Object.entries({
    'marionette.port': port, 'app.update.enabled': false, 'datareporting.policy.dataSubmissionEnabled': false, 'toolkit.telemetry.enabled': false, 'browser.shell.checkDefaultBrowser': false,
    'network.captive-portal-service.enabled': false, 'network.connectivity-service.enabled': false, 'services.settings.server': 'data:,', 'webgl.force-enabled': true, 'browser.startup.homepage': 'about:blank',
  }).map(([name, value]) => `user_pref(${JSON.stringify(name)}, ${JSON.stringify(value)});\n`).join(''));
  // On a screen that nobody sees: without any, Firefox has no WebGL.
  const {display, close} = screen(), ended = start(firefox, ['--marionette', '--no-remote', '--profile', folder], {DISPLAY: display, HOME: folder, LIBGL_ALWAYS_SOFTWARE: '1', MOZ_ENABLE_WAYLAND: '0'});
  const end = async () => { await ended(); await close(); };
  let socket;
  for (const since = Date.now(); !socket; await pause(200)) {
    if (Date.now() - since > PATIENCE) { await end(); throw new Error('Firefox opens no Marionette'); }
    socket = await new Promise((resolve) => { const s = connect(port, '127.0.0.1', () => resolve(s)); s.on('error', () => resolve(undefined)); });
  }
  let bytes = Buffer.alloc(0), count = 0;
  const waiting = new Map();
  socket.on('data', (more) => {
    bytes = Buffer.concat([bytes, more]);
    for (;;) {
      const colon = bytes.indexOf(':'), length = Number(bytes.subarray(0, colon));
      if (colon < 0 || bytes.length < colon + 1 + length) return;
      const message = JSON.parse(bytes.subarray(colon + 1, colon + 1 + length));
      bytes = bytes.subarray(colon + 1 + length);
      if (Array.isArray(message)) waiting.get(message[1])(message);
    }
  });
  const call = (command, values = {}) => new Promise((resolve, reject) => {
    const text = JSON.stringify([0, ++count, `WebDriver:${command}`, values]);
    waiting.set(count, ([, , error, result]) => (error ? reject(new Error(`${error.error}: ${error.message}`)) : resolve(result?.value === undefined ? result : result.value)));
    socket.write(`${Buffer.byteLength(text)}:${text}`);
  });
  await call('NewSession', {});
  return {call, end: () => { socket.destroy(); return end(); }};
}

/** The names of WebDriver's commands as addresses. */
const ADDRESSES = {Navigate: 'url', ExecuteScript: 'execute/sync', PerformActions: 'actions', TakeScreenshot: 'screenshot', SetWindowRect: 'window/rect'};

async function openWebKit(folder, environment) {
  const {display, close} = screen(), port = await freePort();
  const driver = start('dbus-run-session', ['--', 'WebKitWebDriver', `--port=${port}`],
    {DISPLAY: display, XDG_RUNTIME_DIR: folder, HOME: folder, LIBGL_ALWAYS_SOFTWARE: '1', WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS: '1', WEBKIT_DISABLE_DMABUF_RENDERER: '1', ...environment});
  const end = async () => { await driver(); await close(); };
  const ask = async (method, path, body) => {
    const answer = await fetch(`http://127.0.0.1:${port}${path}`, {method, body: body && JSON.stringify(body), signal: AbortSignal.timeout(PATIENCE)});
    const {value} = await answer.json();
    if (!answer.ok) throw new Error(`${value.error}: ${value.message}`);
    return value;
  };
  try {
    for (const since = Date.now(); !await ask('GET', '/status').catch(() => undefined); await pause(200)) if (Date.now() - since > PATIENCE) throw new Error('WebKitWebDriver does not answer');
    const {sessionId} = await ask('POST', '/session', {capabilities: {alwaysMatch: {'webkitgtk:browserOptions': {binary: miniBrowser, args: ['--automation']}}}});
    const method = (command) => (command === 'TakeScreenshot' ? 'GET' : 'POST');
    return {call: (command, values = {}) => ask(method(command), `/session/${sessionId}/${ADDRESSES[command]}`, method(command) === 'POST' ? values : undefined), end};
  } catch (error) {
    await end();
    throw error;
  }
}

/** A browser: pages, questions to them, a mouse, pictures. */
export async function drive(name, environment = {}) {
  const folder = mkdtempSync(join(tmpdir(), 'carom-browser-'));
  const {call, end} = await (name === 'Firefox' ? openFirefox(folder) : openWebKit(folder, environment));
  const evaluate = (f, ...args) => call('ExecuteScript', {script: `return (${f}).apply(null, arguments);`, args});
  const mouse = (...actions) => call('PerformActions', {actions: [{type: 'pointer', id: 'mouse', parameters: {pointerType: 'mouse'}, actions}]});
  const move = (x, y, duration = 0) => ({type: 'pointerMove', x: Math.round(x), y: Math.round(y), duration, origin: 'viewport'});
  return {
    evaluate,
    open: async (url) => { await call('Navigate', {url: 'about:blank'}); await call('Navigate', {url}); },
    size: (width, height) => call('SetWindowRect', {width, height}),
    /** Waits until something is so, and says what it was. */
    until: async (f, ...args) => {
      for (const since = Date.now();; await pause(100)) {
        const found = await evaluate(f, ...args);
        if (found) return found;
        if (Date.now() - since > PATIENCE) throw new Error(`never came true in ${name}: ${f}`);
      }
    },
    press: (x, y) => mouse(move(x, y), {type: 'pointerDown', button: 0}),
    drag: (x, y) => mouse(move(x, y, 300)),
    release: () => mouse({type: 'pointerUp', button: 0}),
    picture: async (file) => { writeFileSync(file, Buffer.from(await call('TakeScreenshot', {full: false}), 'base64')); },
    close: async () => { await end(); rmSync(folder, {recursive: true, force: true, maxRetries: 5}); },
  };
}
