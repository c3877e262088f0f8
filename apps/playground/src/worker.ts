// The engine in the page: the same simulation host as `carom serve` runs, compiled to WebAssembly. Carries the
// messages of docs/protocol.md; the module's exports are documented in apps/wasm/exports.cpp.
import {compile, share, system} from './module';
import {Parts} from './parts';
import type {Start} from './thread';

interface Exports {
  _initialize(): void;
  carom_room(size: number): number;
  carom_file(nameSize: number): void;
  carom_start(): void;
  carom_receive(): void;
  carom_receive_binary(): void;
  carom_advance(seconds: number): void;
  carom_take(): number;
  carom_message(): number;
  carom_workers(count: number): void;
  carom_worker_room(): number;
}

const FRAME = 1000 / 60;  // ms
const MOST_THREADS = 8;
const {memory, threads} = share(MOST_THREADS);
const text = {encode: new TextEncoder(), decode: new TextDecoder()};
let host: Exports | undefined;
let last = performance.now();
const early: (string | ArrayBuffer)[] = [];
let failure = '';

function put(bytes: Uint8Array): void {
  const at = host!.carom_room(bytes.length);
  new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
}

/** The rest of what the host has to say. Copied first: shared memory is neither sent nor read as text. */
function drain(): void {
  for (let size = host!.carom_take(); size >= 0; size = host!.carom_take()) {
    const bytes = new Uint8Array(memory.buffer, host!.carom_message(), size >> 1).slice();
    if (size & 1) postMessage(text.decode.decode(bytes));
    else postMessage(bytes.buffer, {transfer: [bytes.buffer]});
  }
}

function receive(data: string | ArrayBuffer): void {
  if (failure) complain();
  if (!host) { early.push(data); return; }
  put(typeof data === 'string' ? text.encode.encode(data) : new Uint8Array(data));
  if (typeof data === 'string') host.carom_receive(); else host.carom_receive_binary();
  drain();
}

/** To a page that listens: one that has spoken. */
function complain(): void { postMessage(JSON.stringify({type: 'error', message: failure})); }

function tick(): void {
  const now = performance.now();
  host!.carom_advance((now - last) / 1000);
  last = now;
  drain();
  // A step that takes long must not starve the page's messages.
  setTimeout(tick, Math.max(0, FRAME - (performance.now() - now)));
}

/** Workers for the engine's threads. It does not wait for them: until they are there it does everything itself. */
function lend(module: WebAssembly.Module): void {
  host!.carom_workers(threads - 1);
  for (let i = 1; i < threads; ++i) {
    const worker = new Worker(new URL('thread.js', location.href), {type: 'module'});
    const start: Start = {module, memory, room: host!.carom_worker_room()};
    worker.postMessage(start);
  }
}

/** `i32.const 0; i8x16.splat; drop`: four-lane arithmetic, which browsers learned between 2021 and 2023. */
const LANES = new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 10, 9, 1, 7, 0, 65, 0, 253, 15, 26, 11]);

async function start(): Promise<void> {
  if (typeof WebAssembly !== 'object' || !WebAssembly.validate(LANES)) throw new Error('it is WebAssembly with SIMD, which this browser lacks; Chrome has it from 91 on, Firefox from 89, Safari from 16.4');
  const [module, files] = await Promise.all([compile('carom.wasm', threads > 1), fetch('files.json').then((answer) => answer.json() as Promise<Record<string, string>>)]);
  const parts = new Parts(module, threads > 1);
  const instance = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: system(memory), env: {memory}, ...parts.imports()});
  const made = instance.exports as unknown as Exports;
  parts.begin(instance.exports);
  made._initialize();
  host = made;
  lend(module);
  for (const [name, file] of Object.entries(files)) {
    const head = text.encode.encode(name), bytes = text.encode.encode(name + file);
    put(bytes);
    host.carom_file(head.length);
  }
  host.carom_start();
  for (const data of early.splice(0)) receive(data);
  last = performance.now();
  tick();
}

onmessage = (event: MessageEvent<string | ArrayBuffer>) => receive(event.data);
start().catch((error) => {
  failure = `The engine cannot be loaded: ${error}`;
  if (early.length > 0) complain();
});
