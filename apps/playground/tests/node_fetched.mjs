// node --liftoff-only node_fetched.mjs FOLDER FRAMES DEMO…: which files of the engine in FOLDER each demo or scene loads until
// so many frames have passed, and what it says of itself, one line of JSON each. Parts come as they do in a page (src/parts.ts), from the folder.
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {withMemory} from '../../wasm/memory.mjs';
import {makeHost} from '../../wasm/split.mjs';

const [folder, frames, ...demos] = process.argv.slice(2);
const compiled = new Map();
const compile = (file) => {
  if (!compiled.has(file)) compiled.set(file, new WebAssembly.Module(withMemory(readFileSync(join(folder, file)), true)));
  return compiled.get(file);
};
const main = compile('carom.wasm'), files = JSON.parse(readFileSync(join(folder, 'files.json'), 'utf8'));
const list = JSON.parse(new TextDecoder().decode(WebAssembly.Module.customSections(main, 'parts')[0]));

for (const demo of demos) {
  const loaded = new Set();
  let exports, memory;
  const table = () => Object.values(exports).find((e) => e instanceof WebAssembly.Table);
  const parts = {
    imports: () => Object.fromEntries(Object.keys(list).map((part) => [part, new Proxy({}, {get: (_, place) => (...values) => {
      if (!loaded.has(part)) new WebAssembly.Instance(compile(list[part]), {main: exports});
      loaded.add(part);
      return table().get(Number(place))(...values);
    }})])),
    begin: (...made) => { [exports, memory] = made; },
  };
  let seen = 0;
  const host = makeHost(main, files, {parts, frame: () => { ++seen; }});
  host.send({type: 'open', demo, parameters: {}});
  for (let i = 0; i < Number(frames); ++i) host.advance(1 / 60);
  const said = (type) => host.said.find((message) => message.type === type), {summary, text} = said('opened') ?? {};
  console.log(JSON.stringify({demo, seen, wrong: said('error')?.message, words: [summary, text], files: ['carom.wasm', ...[...loaded].map((part) => list[part])]}));
}
