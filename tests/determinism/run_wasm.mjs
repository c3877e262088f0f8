// node run_wasm.mjs [--workers N] PROGRAM.wasm [ARGUMENT…]: runs a WASI program and ends with its exit code. Threads of
// the program find N workers (carom/core/detail/threads_wasm.cpp); by default none.
import {readFileSync} from 'node:fs';
import {WASI} from 'node:wasi';
import {isMainThread, Worker, workerData} from 'node:worker_threads';

const instantiate = (module, memory, args) => {
  const wasi = new WASI({version: 'preview1', args, env: {}, returnOnExit: true});
  return {wasi, instance: new WebAssembly.Instance(module, {wasi_snapshot_preview1: wasi.wasiImport, env: {memory}})};
};

if (isMainThread) {
  const args = process.argv.slice(2);
  const workers = args[0] === '--workers' ? Number(args.splice(0, 2)[1]) : 0;
  const module = await WebAssembly.compile(readFileSync(args[0]));
  const memory = new WebAssembly.Memory({initial: 256, maximum: 65536, shared: true});
  const {wasi, instance} = instantiate(module, memory, args);
  const {carom_workers, carom_worker_room} = instance.exports;
  carom_workers(workers);
  for (let i = 0; i < workers; ++i) new Worker(new URL(import.meta.url), {workerData: {module, memory, room: carom_worker_room()}});
  process.exit(wasi.start(instance));
} else {
  const {module, memory, room} = workerData;
  const {instance: {exports}} = instantiate(module, memory, []);
  exports.__stack_pointer.value = room;
  exports.__wasm_init_tls(room);
  try {
    exports.carom_worker();
  } finally {
    exports.carom_worker_failed();
  }
}
