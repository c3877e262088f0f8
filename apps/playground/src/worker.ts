// The engine in the page: the same simulation host as `carom serve` runs, compiled to WebAssembly. Carries the
// messages of docs/protocol.md; the module's exports are documented in apps/wasm/exports.cpp.
import {Parts} from './parts';

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  carom_room(size: number): number;
  carom_file(nameSize: number): void;
  carom_start(): void;
  carom_receive(): void;
  carom_receive_binary(): void;
  carom_advance(seconds: number): void;
  carom_take(): number;
  carom_message(): number;
}

const FRAME = 1000 / 60;  // ms
const text = {encode: new TextEncoder(), decode: new TextDecoder()};
let host: Exports | undefined;
let last = performance.now();
const early: (string | ArrayBuffer)[] = [];

/** What the C library asks of a system: a clock, and somewhere to complain. */
function system(memory: () => ArrayBuffer): Record<string, (...args: never[]) => number> {
  const BAD_HANDLE = 8;
  return {
    clock_time_get: (_id: number, _precision: bigint, at: number) => {
      new DataView(memory()).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
    fd_write: (_fd: number, list: number, count: number, written: number) => {
      const view = new DataView(memory());
      let said = '', bytes = 0;
      for (let i = 0; i < count; ++i) {
        const size = view.getUint32(list + 8 * i + 4, true);
        said += text.decode.decode(new Uint8Array(memory(), view.getUint32(list + 8 * i, true), size));
        bytes += size;
      }
      console.error(said);
      view.setUint32(written, bytes, true);
      return 0;
    },
    fd_close: () => BAD_HANDLE,
    fd_seek: () => BAD_HANDLE,
  };
}

function put(bytes: Uint8Array): void {
  const at = host!.carom_room(bytes.length);
  new Uint8Array(host!.memory.buffer, at, bytes.length).set(bytes);
}

/** The rest of what the host has to say. Frames go over without a copy of the copy. */
function drain(): void {
  for (let size = host!.carom_take(); size >= 0; size = host!.carom_take()) {
    const bytes = new Uint8Array(host!.memory.buffer, host!.carom_message(), size >> 1);
    if (size & 1) postMessage(text.decode.decode(bytes));
    else {
      const copy = bytes.slice().buffer;
      postMessage(copy, {transfer: [copy]});
    }
  }
}

function receive(data: string | ArrayBuffer): void {
  if (!host) { early.push(data); return; }
  put(typeof data === 'string' ? text.encode.encode(data) : new Uint8Array(data));
  if (typeof data === 'string') host.carom_receive(); else host.carom_receive_binary();
  drain();
}

function tick(): void {
  const now = performance.now();
  host!.carom_advance((now - last) / 1000);
  last = now;
  drain();
  // A step that takes long must not starve the page's messages.
  setTimeout(tick, Math.max(0, FRAME - (performance.now() - now)));
}

/** A server that does not know WebAssembly's type cannot be streamed from. */
async function compile(url: string): Promise<WebAssembly.Module> {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: the server answers ${answer.status}`);
  return answer.headers.get('Content-Type')?.startsWith('application/wasm') ? WebAssembly.compileStreaming(answer) : WebAssembly.compile(await answer.arrayBuffer());
}

async function start(): Promise<void> {
  const [module, files] = await Promise.all([compile('carom.wasm'), fetch('files.json').then((answer) => answer.json() as Promise<Record<string, string>>)]);
  let made: Exports;
  const parts = new Parts(module);
  const instance = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: system(() => made.memory.buffer), ...parts.imports()});
  made = instance.exports as unknown as Exports;
  parts.begin(instance.exports);
  made._initialize();
  host = made;
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
start().catch((error) => postMessage(JSON.stringify({type: 'error', message: `The engine cannot be loaded: ${error}`})));
