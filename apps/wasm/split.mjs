// Cuts the module into what every visitor loads and what comes when it is first called: a visitor downloads little
// before the first demo runs. Which function goes where is measured: an instrumented copy of the module starts, opens
// the demos of every group and says what they called. Whatever is asked of a part that is not there loads it, so the
// cut changes what is downloaded and when, never what is computed. Binaryen's wasm-split does the cutting. What comes
// out is for one thread; a page that may share memory changes a byte of it (memory.mjs).
import {execFileSync} from 'node:child_process';
import {createHash} from 'node:crypto';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {availableParallelism, tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';
import {isMainThread, parentPort, Worker, workerData} from 'node:worker_threads';
import {PAGES, withMemory} from './memory.mjs';

const features = ['--enable-simd', '--enable-threads', '--enable-bulk-memory', '--enable-sign-ext', '--enable-nontrapping-float-to-int', '--enable-mutable-globals'];
const V128 = 0x7b;

/** Type and bytes of every function that the module defines, and whether it exports it. */
function functionsOf(bytes) {
  let at = 8;
  const number = () => { let value = 0, scale = 1, byte; do { byte = bytes[at++]; value += (byte & 127) * scale; scale *= 128; } while (byte & 128); return value; };
  const skip = () => { const size = number(); at += size; };
  const types = [], typeOf = [], functions = [], exported = new Set();
  let imported = 0;
  while (at < bytes.length) {
    const section = bytes[at++], size = number(), end = at + size;
    if (section === 1) for (let n = number(); n > 0; --n) {
      ++at;  // the form: a function
      const values = [];
      for (let side = 0; side < 2; ++side) for (let k = number(); k > 0; --k) values.push(bytes[at++]);
      types.push(values);
    }
    if (section === 2) for (let n = number(); n > 0; --n) {
      skip();
      skip();
      const kind = bytes[at++];
      if (kind === 0) { ++imported; number(); }
      else if (kind === 3) at += 2;
      else { if (kind === 1) ++at; if (bytes[at++] & 1) number(); number(); }
    }
    if (section === 7) for (let n = number(); n > 0; --n) {
      skip();
      const kind = bytes[at++], index = number();
      if (kind === 0) exported.add(index);
    }
    if (section === 3) for (let n = number(); n > 0; --n) typeOf.push(number());
    if (section === 10) for (let n = number(), i = 0; i < n; ++i) {
      const length = number();
      functions.push({code: bytes.subarray(at, at + length), vector: types[typeOf[i]].includes(V128), exported: exported.has(imported + i)});
      at += length;
    }
    at = end;
  }
  return functions;
}

/** What the C library asks of a system: a clock that ticks, nobody who listens. */
function systemOf(memory) {
  let clock = 0;
  return {
    clock_time_get: (_id, _precision, at) => { new DataView(memory.buffer).setBigUint64(at, BigInt(clock += 1000), true); return 0; },
    fd_write: () => 8, fd_close: () => 8, fd_seek: () => 8,
  };
}

/** Which functions an instance of the instrumented module called; written to its memory first. */
function profile(instance, memory, at, count) {
  const size = 8 + 4 * count;
  if (instance.__write_profile(at, size) !== size) throw new Error('the profile is not of this module');
  return new Uint32Array(memory.buffer.slice(at + 8, at + size));
}

/** What thread.ts is in a page. */
function runThread({module, memory, count, notes, room}) {
  const thread = new WebAssembly.Instance(module, {wasi_snapshot_preview1: systemOf(memory), env: {memory}}).exports;
  thread.__stack_pointer.value = room;
  thread.__wasm_init_tls(room);
  thread.carom_worker();
  return profile(thread, memory, notes, count);
}

/** A simulation host of a compiled module in Node: what worker.ts is in a page. `frame` is told of every frame. */
export function makeHost(module, files, {frame = () => {}, threads = 1, count = 0} = {}) {
  const encode = new TextEncoder(), decode = new TextDecoder(), said = [];
  const memory = new WebAssembly.Memory({...PAGES, shared: true});
  const host = new WebAssembly.Instance(module, {wasi_snapshot_preview1: systemOf(memory), env: {memory}}).exports;
  const put = (bytes) => {
    const at = host.carom_room(bytes.length);  // first: the memory may grow
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
  };
  const send = (message) => { put(encode.encode(JSON.stringify(message))); host.carom_receive(); drain(); };
  const drain = () => {
    for (let size = host.carom_take(); size >= 0; size = host.carom_take()) {
      const bytes = new Uint8Array(memory.buffer, host.carom_message(), size >> 1).slice();
      if (size & 1) said.push(JSON.parse(decode.decode(bytes)));
      else if (bytes[0] === 2) {
        frame(new DataView(bytes.buffer));
        send({type: 'ack', sequence: new DataView(bytes.buffer).getUint32(4, true)});
      }
    }
  };
  host._initialize();
  host.carom_workers(threads - 1);
  // A thread has room to note what it called, and for its stack, whose end `room` is.
  const crew = Array.from({length: threads - 1}, () => new Worker(fileURLToPath(import.meta.url),
    {workerData: {thread: {module, memory, count, notes: host.carom_worker_room() - (1 << 20), room: host.carom_worker_room()}}}));
  const reports = crew.map((worker) => new Promise((resolve, reject) => { worker.once('message', resolve).once('error', reject); }));
  for (const [name, file] of Object.entries(files)) { put(encode.encode(name + file)); host.carom_file(encode.encode(name).length); }
  host.carom_start();
  send({type: 'hello', protocol: 1});
  return {send, said, demos: said[0].demos, advance(seconds) { host.carom_advance(seconds); drain(); }, async called() {
    host.carom_workers(0);
    send({type: 'open', demo: said[0].demos[0].id, parameters: {}});  // what the threads worked on is over
    const all = [profile(host, memory, host.carom_room(8 + 4 * count), count), ...await Promise.all(reports)];
    return all[0].map((_, i) => (all.some((one) => one[i]) ? 1 : 0));
  }};
}

/** The list of demos and scenes (`menu` of exports.cpp), as the module itself declares it. */
export async function menuOf(modulePath, files) {
  return JSON.stringify(makeHost(await WebAssembly.compile(readFileSync(modulePath)), files).demos);
}

/** What the first seconds of these demos call, within so much time of this machine each, and what is done with any. */
async function runDemos({module, files, count}, {demos, seconds, patience, threads}) {
  const host = makeHost(module, files, {threads, count});
  for (const demo of demos) {
    host.send({type: 'open', demo, parameters: {}});
    const until = performance.now() + 1000 * patience;
    for (let frame = 0; frame < 60 * seconds && performance.now() < until; ++frame) host.advance(1 / 60);
  }
  const ray = {pointer: 1, origin: [0, 1, 10], direction: [0, 0, -1]};
  for (const message of [{type: 'pause'}, {type: 'step', count: 1}, {type: 'speed', value: 1}, {type: 'draw', layers: []}, {type: 'grab', ...ray},
    {type: 'drag', pointer: 1, target: [0, 2, 0]}, {type: 'run'}, {type: 'release', pointer: 1}, {type: 'restart'}]) {
    host.send(message);
    host.advance(1 / 60);
  }
  return host.called();
}

if (workerData?.thread) parentPort.postMessage(runThread(workerData.thread));
else if (!isMainThread && workerData?.module) parentPort.on('message', (set) => { runDemos(workerData, set).then((called) => parentPort.postMessage(called)); });

/** Runs the sets of demos side by side, each by a host of its own; gives what each called. */
async function runAll(data, sets) {
  const results = [];
  let next = 0;
  await Promise.all(Array.from({length: Math.min(availableParallelism(), sets.length)}, async () => {
    const worker = new Worker(fileURLToPath(import.meta.url), {workerData: data});
    while (next < sets.length) {
      const index = next++;
      results[index] = await new Promise((resolve, reject) => {
        worker.removeAllListeners();
        worker.once('message', resolve).once('error', reject).postMessage(sets[index]);
      });
    }
    await worker.terminate();
  }));
  return results;
}

/**
 * Function → the part that holds it, from what the first demo and every set of demos call. In `main`: what start-up and
 * the first demo call, and whatever takes vectors, because a call that loads a part goes through JavaScript, which has
 * none. What the demos of one group call is a part of its own; a scene file, which may have the models of every group,
 * loads the parts of those it has. What several groups, or one and most scene files, call is `plane` or `shared`, what
 * nobody calls (errors, tools, what a hand does) the `rest`.
 */
function assign(functions, first, sets, called) {
  const small = 20e3;  // bytes that are worth a request of their own
  const isScene = (set) => set.group === 'Scenes', most = sets.filter(isScene).length / 2;
  const part = functions.map((f, i) => {
    if (f.vector || f.exported || first.some((called) => called[i])) return 'main';
    const users = sets.filter((_, s) => called[s][i]), demos = users.filter((s) => !isScene(s));
    if (users.length === 0) return 'rest';
    if (demos.length === 0) return 'Scenes';
    if (users.length - demos.length > most) return 'shared';
    if (demos.every((s) => s.group === demos[0].group)) return demos[0].group;
    return demos.every((s) => s.dimension === 2) ? 'plane' : 'shared';
  });
  const size = {};
  functions.forEach((f, i) => { size[part[i]] = (size[part[i]] ?? 0) + f.code.length; });
  return part.map((name) => (size[name] < small ? 'small' : name));
}

/** Splits `modulePath` into OUT/carom.wasm and its parts; returns what was made, by name: file and bytes gzipped. */
export async function split(modulePath, files, out) {
  const scratch = mkdtempSync(join(tmpdir(), 'carom-split-'));
  const path = (name) => join(scratch, name);
  const wasmSplit = (...args) => execFileSync('wasm-split', [...features, ...args], {stdio: 'inherit'});
  try {
    const whole = readFileSync(modulePath), functions = functionsOf(whole);
    wasmSplit('--instrument', modulePath, '-o', path('instrumented.wasm'));
    const module = await WebAssembly.compile(readFileSync(path('instrumented.wasm')));
    const data = {module, files, count: functions.length};
    const demos = makeHost(module, files).demos.filter((d) => !d.group.startsWith('Stress'));
    const sets = [];
    for (const {id, group, dimension} of demos) {
      let set = group === 'Scenes' ? undefined : sets.find((s) => s.group === group && s.dimension === dimension);  // each scene file is another
      if (!set) sets.push(set = {group, dimension, demos: [], seconds: 1.5, patience: 6, threads: 2});
      set.demos.push(id);
    }
    const starts = [1, 2].map((threads) => ({demos: [demos[0].id], seconds: 20, patience: 20, threads}));
    const all = await runAll(data, [...starts, ...sets]), first = all.slice(0, starts.length), called = all.slice(starts.length);
    const part = assign(functions, first, sets, called);
    // The parts that most demos need are fetched first.
    const users = (name) => sets.filter((_, s) => part.some((p, i) => p === name && called[s][i])).length;
    const names = [...new Set(part)].filter((name) => name !== 'main').sort().sort((a, b) => users(b) - users(a));
    const made = {}, listed = {};
    let primary = modulePath;
    names.forEach((name, k) => {
      // Without a name section wasm-split calls functions by their number.
      writeFileSync(path('functions'), part.flatMap((p, i) => (p === name ? [i] : [])).join('\n'));
      const last = k === names.length - 1;
      wasmSplit('--split', primary, `--split-funcs=@${path('functions')}`, '-o1', path(`main${k}.wasm`), '-o2', path('part.wasm'),
        '--import-namespace=main', `--placeholder-namespace=part${k}`, ...(last ? [] : ['-g']));
      primary = path(`main${k}.wasm`);
      // (The names that the next cut goes by were written to the part too.)
      if (!last) execFileSync('wasm-opt', [...features, '--strip-debug', path('part.wasm'), '-o', path('part.wasm')], {stdio: 'inherit'});
      const bytes = withMemory(readFileSync(path('part.wasm')), false);
      const file = `carom-${name.toLowerCase().replace(/\W+/g, '-')}-${createHash('sha256').update(bytes).digest('hex').slice(0, 8)}.wasm`;
      writeFileSync(join(out, file), bytes);
      made[name] = {file, bytes: gzipSync(bytes, {level: 9}).length};
      listed[`part${k}`] = file;
    });
    const main = Buffer.concat([withMemory(readFileSync(primary), false), customSection('parts', JSON.stringify(listed))]);
    writeFileSync(join(out, 'carom.wasm'), main);
    return {main: {file: 'carom.wasm', bytes: gzipSync(main, {level: 9}).length}, ...made};
  } finally {
    rmSync(scratch, {recursive: true, force: true});
  }
}

/** A custom section of WebAssembly: id 0, size, name, content. */
function customSection(name, content) {
  const leb = (value) => { const out = []; do { out.push((value & 127) | (value > 127 ? 128 : 0)); value >>= 7; } while (value > 0); return Buffer.from(out); };
  const body = Buffer.concat([leb(name.length), Buffer.from(name), Buffer.from(content)]);
  return Buffer.concat([Buffer.from([0]), leb(body.length), body]);
}
