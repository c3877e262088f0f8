// node --liftoff-only node_hashes.mjs MODULE FILES.json NAME=STEPS…: prints the state hash of every demo or scene after so
// many steps of the engine as WebAssembly in Node, one a line. (--liftoff-only: V8 of Node 20 now and then crashes in its
// optimising compiler on the largest functions.)
import {readFileSync} from 'node:fs';
import {makeHost} from '../../wasm/split.mjs';

const [module, files, ...runs] = process.argv.slice(2);
const compiled = await WebAssembly.compile(readFileSync(module));
let last;
const host = makeHost(compiled, JSON.parse(readFileSync(files, 'utf8')), {frame: (frame) => {
  if (frame.getUint8(1) & 2) last = {step: frame.getUint32(8, true), hash: frame.getBigUint64(frame.byteLength - 16, true)};
}});
for (const run of runs) {
  const [name, steps] = [run.slice(0, run.lastIndexOf('=')), Number(run.slice(run.lastIndexOf('=') + 1))];
  host.said.length = 0;
  host.send({type: 'open', demo: name});
  host.send({type: 'pause'});
  host.send({type: 'restart'});
  last = undefined;
  for (let asked = 0; asked < steps; asked += 100) host.send({type: 'step', count: Math.min(100, steps - asked)});
  for (let turn = 0; last?.step !== steps; ++turn) {
    const wrong = host.said.find((message) => message.type === 'error');
    if (wrong || turn > 1e5) throw new Error(`${name}: ${wrong?.message ?? `at step ${last?.step}`}`);
    host.advance(1 / 60);
  }
  console.log(last.hash.toString(16).padStart(16, '0'));
}
