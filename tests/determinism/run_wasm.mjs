// node run_wasm.mjs PROGRAM.wasm [ARGUMENT…]: runs a WASI program and ends with its exit code.
import {readFileSync} from 'node:fs';
import {WASI} from 'node:wasi';

const [program, ...args] = process.argv.slice(2);
const wasi = new WASI({version: 'preview1', args: [program, ...args], env: {}});
const instance = await WebAssembly.instantiate(await WebAssembly.compile(readFileSync(program)), {wasi_snapshot_preview1: wasi.wasiImport});
process.exitCode = wasi.start(instance);
