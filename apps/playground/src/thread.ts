// A thread of the engine: another instance of its module on its memory, with a stack of its own. It does what the
// engine has for it and never returns (carom/core/detail/threads_wasm.cpp).
import {system} from './module';
import {Parts} from './parts';

interface Exports {
  __stack_pointer: WebAssembly.Global;
  __wasm_init_tls(at: number): void;
  carom_worker(): void;
  carom_worker_failed(): void;
}
/** What the engine's Worker hands over; `room` is the end of this thread's stack. */
export interface Start { module: WebAssembly.Module; memory: WebAssembly.Memory; room: number }

onmessage = async ({data: {module, memory, room}}: MessageEvent<Start>) => {
  const parts = new Parts(module, true);
  const instance = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: system(memory), env: {memory}, ...parts.imports()});
  const engine = instance.exports as unknown as Exports;
  parts.begin(instance.exports);
  engine.__stack_pointer.value = room;
  engine.__wasm_init_tls(room);
  try {
    engine.carom_worker();
  } catch (error) {
    console.error(`A thread of the engine stopped: ${error}`);
    engine.carom_worker_failed();  // the engine must not wait for it
  }
};
