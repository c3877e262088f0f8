// Cuts the module into what every visitor loads and what comes when it is first called: a visitor downloads little
// before the first demo runs. Which function goes where is measured: an instrumented copy of the module starts, opens
// the demos of every group and says what they called. Whatever is asked of a part that is not there loads it, so the
// cut changes what is downloaded and when, never what is computed. Binaryen's wasm-split does the cutting. What comes
// out is for one thread; a page that may share memory changes a byte of it (memory.mjs).
import {execFile} from 'node:child_process';
import {createHash} from 'node:crypto';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {availableParallelism, tmpdir} from 'node:os';
import {join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';
import {gzipSync} from 'node:zlib';
import {isMainThread, parentPort, Worker, workerData} from 'node:worker_threads';
import {PAGES, withMemory} from './memory.mjs';
import {leb, moveTexts} from './texts.mjs';

const features = ['--enable-simd', '--enable-threads', '--enable-bulk-memory', '--enable-sign-ext', '--enable-nontrapping-float-to-int', '--enable-mutable-globals'];
const V128 = 0x7b;

/** Of every function that the module defines: its number, its bytes, whether it takes vectors, and whether it is exported or has a place in the table. */
function functionsOf(bytes) {
  let at = 8;
  const number = () => { let value = 0, scale = 1, byte; do { byte = bytes[at++]; value += (byte & 127) * scale; scale *= 128; } while (byte & 128); return value; };
  const skip = () => { const size = number(); at += size; };
  const types = [], typeOf = [], functions = [], exported = new Set();
  let elements = new Uint8Array();
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
    if (section === 9) elements = bytes.subarray(at, end);
    if (section === 3) for (let n = number(); n > 0; --n) typeOf.push(number());
    if (section === 10) for (let n = number(), i = 0; i < n; ++i) {
      const length = number();
      functions.push({index: imported + i, code: bytes.subarray(at, at + length), vector: types[typeOf[i]].includes(V128), exported: exported.has(imported + i)});
      at += length;
    }
    at = end;
  }
  const listed = new Set(numbersIn(elements, () => true));
  for (const f of functions) f.listed = listed.has(f.index);
  return functions;
}

/** What the bytes may say in WebAssembly's numbers, wherever one may begin: more than they do say, but nothing less. */
function* numbersIn(bytes, begins) {
  for (let at = 0; at < bytes.length; ++at) {
    if (!begins(bytes, at)) continue;
    let value = 0, scale = 1, k = at;
    for (; bytes[k] & 128 && scale < 1 << 28; ++k, scale *= 128) value += (bytes[k] & 127) * scale;
    yield value + bytes[k] * scale;
  }
}
const CALLS = [0x10, 0x12, 0xd2];  // call, return_call, ref.func

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

/**
 * A simulation host of a compiled module in Node: what worker.ts is in a page. `frame` is told of every frame; `parts`,
 * of a module that is cut, gives what it imports in place of its parts and is handed its exports.
 */
export function makeHost(module, files, {frame = () => {}, threads = 1, count = 0, parts} = {}) {
  const encode = new TextEncoder(), decode = new TextDecoder(), said = [];
  const memory = new WebAssembly.Memory({...PAGES, shared: true});
  const host = new WebAssembly.Instance(module, {wasi_snapshot_preview1: systemOf(memory), env: {memory}, ...parts?.imports()}).exports;
  parts?.begin(host, memory);
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
    if (threads > 1) {
      host.carom_workers(0);
      send({type: 'open', demo: said[0].demos[0].id, parameters: {}});  // what the threads worked on is over
    }
    const all = [profile(host, memory, host.carom_room(8 + 4 * count), count), ...await Promise.all(reports)];
    return all[0].map((_, i) => (all.some((one) => one[i]) ? 1 : 0));
  }};
}

/** The list of demos and scenes (`menu` of exports.cpp), as the module itself declares it. */
export async function menuOf(modulePath, files) {
  return JSON.stringify(makeHost(await WebAssembly.compile(readFileSync(modulePath)), files).demos);
}

/** What these demos call in so many frames each, and what is done with any. `patience`: s that they may take of this machine. */
async function runDemos({module, files, count}, {demos, frames, patience, threads}) {
  const host = makeHost(module, files, {threads, count});
  const until = performance.now() + 1000 * patience;
  const advance = (n) => { for (; n > 0 && performance.now() < until; --n) host.advance(1 / 60); };
  const ray = {pointer: 1, origin: [0, 1, 10], direction: [0, 0, -1]};
  for (const demo of demos) {
    host.send({type: 'open', demo, parameters: {}});
    advance(frames);
    for (const message of [{type: 'pause'}, {type: 'step', count: 1}, {type: 'speed', value: 1}, {type: 'draw', layers: []}, {type: 'grab', ...ray},
      {type: 'drag', pointer: 1, target: [0, 2, 0]}, {type: 'run'}, {type: 'release', pointer: 1}]) {
      host.send(message);
      advance(1);
    }
  }
  host.send({type: 'restart'});
  advance(1);
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

/** Which of the users (a bit each) call what: bits of the words of two lists, weighed. */
function weightOf(weights, one, other = one) {
  let sum = 0;
  for (let w = 0; w < one.length; ++w) for (let bits = one[w] | other[w]; bits; bits &= bits - 1) sum += weights[32 * w + 31 - Math.clz32(bits & -bits)];
  return sum;
}

/**
 * Joins what belongs together until nothing is gained by it: always the two whose union costs users least. A user pays for
 * every byte of what it loads and for every request; a file costs by itself too. `groups`: {users, bytes, functions}.
 */
function joined(groups, weights) {
  const REQUEST = 15e3, FILE = 3e5;  // as much as so many bytes, of a request to its user and of a file to all
  const weigh = (group) => Object.assign(group, {weight: weightOf(weights, group.users)});
  const gain = (a, b) => FILE + a.weight * (a.bytes + REQUEST) + b.weight * (b.bytes + REQUEST) - weightOf(weights, a.users, b.users) * (a.bytes + b.bytes + REQUEST);
  const list = groups.map(weigh), best = [];
  const find = (i) => {
    best[i] = {gain: 0};
    for (let j = 0; j < list.length; ++j) {
      if (j === i || !list[j]) continue;
      const g = gain(list[i], list[j]);
      if (g > best[i].gain) best[i] = {gain: g, with: j};
    }
  };
  list.forEach((_, i) => find(i));
  for (;;) {
    const i = best.reduce((most, b, k) => (list[k] && b.gain > (best[most]?.gain ?? 0) ? k : most), -1);
    if (i < 0) return list.filter(Boolean);
    const j = best[i].with, [a, b] = [list[i], list[j]];
    list[i] = weigh({users: a.users.map((bits, w) => bits | b.users[w]), bytes: a.bytes + b.bytes, functions: [...a.functions, ...b.functions]});
    list[j] = undefined;
    list.forEach((group, k) => {
      if (!group) return;
      if (k === i || best[k].with === i || best[k].with === j) find(k);
      else if (gain(group, list[i]) > best[k].gain) best[k] = {gain: gain(group, list[i]), with: i};
    });
  }
}

/**
 * The parts of the module, from what the first demo and every other one call: {name, functions}, those first that most
 * demos need. What start-up and the first demo call stays where it is, and so does whatever takes vectors, because a call
 * that loads a part goes through JavaScript, which has none. The rest goes by who calls it; demos that call much count
 * more. What nobody calls (errors, tools) is cut by its place, since neighbours are of one source. A
 * function that takes vectors goes along where all who call it are of one part.
 */
function partsOf(functions, first, sets, called) {
  const byUsers = new Map(), rest = [];
  functions.forEach((f, i) => {
    if (f.vector || f.exported || first.some((one) => one[i])) return;
    const users = new Uint32Array(Math.ceil(sets.length / 32));
    called.forEach((one, s) => { if (one[i]) users[s >> 5] |= 1 << (s & 31); });
    if (users.every((bits) => bits === 0)) { rest.push(i); return; }
    const group = byUsers.get(users.join()) ?? {users, bytes: 0, functions: []};
    byUsers.set(users.join(), group);
    group.bytes += f.code.length;
    group.functions.push(i);
  });
  const groups = [...byUsers.values()];
  const needs = sets.map((_, s) => groups.reduce((sum, g) => sum + (g.users[s >> 5] >>> (s & 31) & 1) * g.bytes, 0));
  const middle = [...needs].sort((a, b) => a - b)[needs.length >> 1];
  const users = (group) => sets.filter((_, s) => group.users[s >> 5] >>> (s & 31) & 1);
  const made = joined(groups, needs.map((bytes) => Math.max(1, bytes / middle) ** 2.5));
  // Named by the group most of whose demos it is of.
  const parts = made.map((group) => {
    const all = users(group), count = (name) => all.filter((s) => s.group === name).length / sets.filter((s) => s.group === name).length;
    return {of: all.reduce((most, s) => (count(s.group) > count(most) ? s.group : most), all[0].group), users: all.length, functions: group.functions.sort((a, b) => a - b)};
  });
  for (let at = 0; at < rest.length;) {
    const part = {of: 'rest', users: 0, functions: []};
    for (let bytes = 0; at < rest.length && bytes < 120e3; ++at) { part.functions.push(rest[at]); bytes += functions[rest[at]].code.length; }
    parts.push(part);
  }
  const partOf = new Map(parts.flatMap((part) => part.functions.map((i) => [i, part]))), callers = new Map();
  functions.forEach((f, i) => { if (f.vector && !f.exported && !f.listed && !first.some((one) => one[i])) callers.set(f.index, {i, from: new Set()}); });
  functions.forEach((f, i) => { for (const index of numbersIn(f.code, (code, at) => at > 0 && CALLS.includes(code[at - 1]))) callers.get(index)?.from.add(i); });
  for (let moved = true; moved;) {
    moved = false;
    for (const [index, {i, from}] of callers) {
      const to = new Set([...from].filter((caller) => caller !== i).map((caller) => partOf.get(caller)));
      if (to.size !== 1 || to.has(undefined)) continue;
      partOf.set(i, [...to][0]);
      partOf.get(i).functions.push(i);
      callers.delete(index);
      moved = true;
    }
  }
  const seen = {};
  return parts.sort((a, b) => b.users - a.users).map((part) => {
    seen[part.of] = (seen[part.of] ?? 0) + 1;
    return {name: `${part.of.replace(/:.*/, '').toLowerCase().replace(/\W+/g, '-')}${seen[part.of] > 1 ? `-${seen[part.of]}` : ''}`, functions: part.functions};
  });
}

/** Splits `modulePath` into OUT/carom.wasm and its parts; returns what was made, by name: file and bytes gzipped. */
export async function split(modulePath, files, out) {
  const scratch = mkdtempSync(join(tmpdir(), 'carom-split-'));
  const path = (name) => join(scratch, name);
  // Whoever loads what comes out validates it.
  const wasmSplit = (...args) => promisify(execFile)('wasm-split', [...features, '--no-validation', ...args]);
  try {
    const whole = readFileSync(modulePath), functions = functionsOf(whole);
    await wasmSplit('--instrument', modulePath, '-o', path('instrumented.wasm'));
    const module = await WebAssembly.compile(readFileSync(path('instrumented.wasm')));
    const data = {module, files, count: functions.length};
    const {demos} = makeHost(module, files), sets = [];
    for (const {id, group, dimension} of demos) {
      const stress = group.startsWith('Stress');
      sets.push({group, demos: [id], frames: stress ? 24 : 160, patience: 15, threads: 1});
      // What more than one thread calls: the first demo of every kind tells.
      if (!stress && !sets.some((s) => s.group === group && s.dimension === dimension)) sets.push({group, dimension, demos: [id], frames: 20, patience: 15, threads: 2});
    }
    const starts = [1, 2].map((threads) => ({demos: [demos[0].id], frames: 1200, patience: 60, threads}));
    const all = await runAll(data, [...starts, ...sets]);
    const parts = partsOf(functions, all.slice(0, starts.length), sets, all.slice(starts.length));
    // Texts go where the functions are that say them.
    const partOf = Array(functions.length);
    parts.forEach((part, k) => { for (const i of part.functions) partOf[i] = k; });
    const {module: lean, sections} = moveTexts(whole, functions, partOf);
    writeFileSync(path('lean.wasm'), lean);
    const made = {}, listed = {};
    const pack = (name, k) => {
      const bytes = withData(withMemory(withoutNames(readFileSync(path(`part${k}.wasm`))), false), sections.get(k));
      const file = `carom-${name}-${createHash('sha256').update(bytes).digest('hex').slice(0, 8)}.wasm`;
      writeFileSync(join(out, file), bytes);
      made[name] = {file, bytes: gzipSync(bytes, {level: 9}).length};
      listed[`part${k}`] = file;
    };
    // What most demos need is cut off first: a part that is cut before one that it calls leaves the way there in what every
    // visitor loads (5 kB in all with the largest first, which would take a third less time).
    let primary = path('lean.wasm');
    for (const [k, part] of parts.entries()) {
      // Without a name section wasm-split calls functions by their number.
      writeFileSync(path('functions'), part.functions.join('\n'));
      const making = wasmSplit('--split', primary, `--split-funcs=@${path('functions')}`, '-o1', path(`main${k}.wasm`), '-o2', path(`part${k}.wasm`),
        '--import-namespace=main', `--placeholder-namespace=part${k}`, ...(k === parts.length - 1 ? [] : ['-g']));
      if (k > 0) pack(parts[k - 1].name, k - 1);  // meanwhile
      await making;
      primary = path(`main${k}.wasm`);
    }
    if (parts.length > 0) pack(parts.at(-1).name, parts.length - 1);
    const main = Buffer.concat([withMemory(readFileSync(primary), false), customSection('parts', JSON.stringify(listed))]);
    writeFileSync(join(out, 'carom.wasm'), main);
    return {main: {file: 'carom.wasm', bytes: gzipSync(main, {level: 9}).length}, ...made};
  } finally {
    rmSync(scratch, {recursive: true, force: true});
  }
}

/** The sections of a module: which, from where, where their content begins and ends. */
function* sectionsOf(module) {
  for (let at = 8; at < module.length;) {
    const begin = at, id = module[at++];
    let size = 0;
    for (let scale = 1; ; scale *= 128) { size += (module[at] & 127) * scale; if (!(module[at++] & 128)) break; }
    yield {id, begin, content: at, end: at + size};
    at += size;
  }
}

/** A module without its name section: the names that the next cut goes by are written to the part too. */
function withoutNames(module) {
  const kept = [module.subarray(0, 8)];
  for (const {id, begin, content, end} of sectionsOf(module)) {
    const named = id === 0 && module[content] === 4 && module.subarray(content + 1, content + 5).toString() === 'name';
    if (!named) kept.push(module.subarray(begin, end));
  }
  return Buffer.concat(kept);
}

/** A module without data, with a section of them: after its code. */
function withData(module, section) {
  if (!section) return module;
  const bytes = Buffer.from(module);
  for (const {id, end} of sectionsOf(bytes)) {
    if (id === 11 || id === 12) throw new Error('a part that has data of its own');
    if (id === 10) return Buffer.concat([bytes.subarray(0, end), section, bytes.subarray(end)]);
  }
  throw new Error('a part without code');
}

/** A custom section of WebAssembly: id 0, size, name, content. */
function customSection(name, content) {
  const body = Buffer.concat([leb(name.length), Buffer.from(name), Buffer.from(content)]);
  return Buffer.concat([Buffer.from([0]), leb(body.length), body]);
}
