// What every instance of the engine's module needs: the module itself, a memory, and the little that the C library
// asks of a system.
import {PAGES, withMemory} from '../../wasm/memory.mjs';

const decoder = new TextDecoder();

/** Memory and threads for this page: several where it is isolated from others, which only its server can do. */
export function share(most: number): {memory: WebAssembly.Memory; threads: number} {
  // An isolated page of WebKitGTK may make shared memory and yet send it to no Worker: there is no SharedArrayBuffer then.
  const threads = globalThis.crossOriginIsolated && typeof SharedArrayBuffer === 'function' ? Math.min(most, navigator.hardwareConcurrency) : 1;
  if (threads > 1) {
    try {
      // All that a shared memory may ever take is set aside at once; a phone has less room for it.
      return {memory: new WebAssembly.Memory({...PAGES, maximum: PAGES.maximum / 4, shared: true}), threads};
    } catch { /* then without */ }
  }
  return {memory: new WebAssembly.Memory(PAGES), threads: 1};
}

/** The module in a file, for a memory of this kind; a server that does not know WebAssembly's type cannot be streamed from. */
export async function compile(url: string, shared: boolean): Promise<WebAssembly.Module> {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: the server answers ${answer.status}`);
  if (!shared && answer.headers.get('Content-Type')?.startsWith('application/wasm')) return WebAssembly.compileStreaming(answer);
  return WebAssembly.compile(withMemory(new Uint8Array(await answer.arrayBuffer()), shared));
}

/** A clock, and somewhere to complain. */
export function system(memory: WebAssembly.Memory): WebAssembly.ModuleImports {
  const BAD_HANDLE = 8;
  return {
    clock_time_get: (_id: number, _precision: bigint, at: number) => {
      new DataView(memory.buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    },
    fd_write: (_fd: number, list: number, count: number, written: number) => {
      const view = new DataView(memory.buffer);
      let said = '', bytes = 0;
      for (let i = 0; i < count; ++i) {
        const size = view.getUint32(list + 8 * i + 4, true);
        said += decoder.decode(new Uint8Array(memory.buffer, view.getUint32(list + 8 * i, true), size).slice());  // it takes no shared memory
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
