// node build.mjs [--web FOLDER --module CAROM.WASM]: bundles the page into dist/, for `carom serve`; with --web into a
// folder that any web server can host, with the engine as WebAssembly, the scenes and the presets.
import {build} from 'esbuild';
import {cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {basename, dirname, join, relative, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {parseArgs} from 'node:util';
import {menuOf, split} from '../wasm/split.mjs';
import {thumbnails} from './thumbnails.mjs';

const here = dirname(fileURLToPath(import.meta.url)), root = join(here, '../..');
const {values: {web, module}} = parseArgs({options: {web: {type: 'string'}, module: {type: 'string'}}});
const out = web ? resolve(web) : join(here, 'dist');

rmSync(out, {recursive: true, force: true});
mkdirSync(out, {recursive: true});
const {metafile} = await build({
  absWorkingDir: here,
  entryPoints: {main: 'src/main.ts', worker: 'src/worker.ts', thread: 'src/thread.ts', ...(web ? {early: 'src/early.ts'} : {}), style: 'src/style.css'},
  bundle: true,
  minify: true,
  sourcemap: false,
  format: 'esm',
  splitting: true,  // the editor comes when it is asked for
  chunkNames: '[name]-[hash]',
  target: ['es2021'],
  outdir: out,
  legalComments: 'linked',
  metafile: true,
});
cpSync(join(here, 'src/icon.svg'), join(out, 'icon.svg'));

/** Scenes by NAME.json, presets by presets/KIND/NAME.json or, of motors, .eng: the names by which scene files ask for each other. */
function dataFiles() {
  const files = {};
  for (const entry of readdirSync(join(root, 'scenes'), {withFileTypes: true}))
    if (entry.isFile() && entry.name.endsWith('.json')) files[entry.name] = readFileSync(join(root, 'scenes', entry.name), 'utf8');
  for (const name of readdirSync(join(root, 'presets'), {recursive: true}))
    if (/\.(json|eng)$/.test(name)) files[relative(root, join(root, 'presets', name))] = readFileSync(join(root, 'presets', name), 'utf8');
  return files;
}
/**
 * Demo id → the C++ that makes it, from the sources that are compiled: without what the page shows anyway (the
 * declaration) and without includes. A file may hold several demos; each then shows all of it.
 */
function demoSources() {
  const sources = {};
  for (const name of readdirSync(join(root, 'apps/host/demos'), {recursive: true}).sort()) {
    if (!name.endsWith('.cpp')) continue;
    const text = readFileSync(join(root, 'apps/host/demos', name), 'utf8');
    const ids = [...text.matchAll(/\bd\.id = ([^;]+);/g)].flatMap((m) => [...m[1].matchAll(/"([^"]+)"/g)].map((id) => id[1]));
    const code = text.replace(/^#include.*\n/gm, '').replace(/^  Declaration declaration\(\) const override \{\n[^]*?\n  \}\n\n?/gm, '').replace(/^namespace [^\n]*\{\n+|^\}  \/\/ namespace.*\n*/gm, '').replace(/\n{3,}/g, '\n\n').trim();
    for (const id of ids) sources[id] = {file: `apps/host/demos/${name}`, code};
  }
  return {...sources, ...stressSources(), scene: {file: 'examples/scene_file.cpp', code: readFileSync(join(root, 'examples/scene_file.cpp'), 'utf8').replace(/^#include.*\n/gm, '').trim()}};
}
/** The same for the benchmark scenes: the class or function that the table of scenes names, with the comment above it. */
function stressSources() {
  const folder = join(root, 'benchmarks'), sources = {};
  const texts = readdirSync(folder).filter((name) => name.endsWith('.cpp')).sort().map((file) => ({file: `benchmarks/${file}`, text: readFileSync(join(folder, file), 'utf8')}));
  for (const {file, text} of texts) {
    for (const [, suite, name, rest] of text.matchAll(/\.suite = "(\w+)",\s*\.name = "(\w+)",([^]*?)(?=\n\s*\{\.suite|\n  \};|\n\s*\{\n?\s*\.suite)/g)) {
      // make<Class>, make_function, or a lambda that calls one.
      const maker = (rest.match(/make<(\w+)/) ?? rest.match(/\.make[23] = (\w+)[,}]/) ?? rest.match(/list_scene<[\w:]+>\((\w+)\(/))?.[1];
      const whole = new RegExp(`(?:^//.*\\n)*(?:^template .*\\n)?^(?:class ${maker}\\b|[\\w:<>]+ ${maker}\\()[^;{]*\\{\\n[^]*?\\n\\}.*`, 'm');
      const short = new RegExp(`^[^;\\n]* ${maker}\\([^;{]*\\{.*\\}$`, 'm');  // it only makes a class, which is all of its file
      const home = [{file, text}, ...texts].find((one) => whole.test(one.text) || short.test(one.text));
      const code = home && (home.text.match(whole)?.[0] ?? home.text.replace(/^#include.*\n/gm, '').trim());
      if (code) sources[`${suite}-${name}`.replace(/_/g, '-')] = {file: home.file, code};
      else console.log(`no source of ${suite}/${name} (${maker})`);
    }
  }
  return sources;
}
const sources = demoSources();
writeFileSync(join(out, 'lessons.json'), JSON.stringify(JSON.parse(readFileSync(join(here, 'lessons.json'), 'utf8'))));
writeFileSync(join(out, 'sources.json'), JSON.stringify(sources));
const pictures = await thumbnails(root, out, sources);
// What the page's script imports, and the engine, are asked for while that script is on its way.
const imported = Object.entries(metafile.outputs).find(([name]) => name.endsWith('/main.js'))[1].imports.filter((i) => i.kind === 'import-statement')
  .map((i) => `<link rel="modulepreload" href="${basename(i.path)}">`);
const early = '<script type="module" src="early.js"></script>';
const page = readFileSync(join(here, 'src/index.html'), 'utf8').replace('name="thumbnails" content=""', `name="thumbnails" content="${pictures.join(' ')}"`)
  .replace('</head>', `${[...imported, ...(web ? [early] : [])].map((line) => `  ${line}\n`).join('')}</head>`);
writeFileSync(join(out, 'index.html'), web ? page.replace('name="engine" content="native"', 'name="engine" content="wasm"') : page);

if (web) {
  const engine = module ?? join(root, 'build/wasm/apps/wasm/carom.wasm'), files = dataFiles();
  files.menu = await menuOf(engine, files);
  writeFileSync(join(out, 'files.json'), JSON.stringify(files));
  for (const [name, {bytes}] of Object.entries(await split(engine, files, out)))
    console.log(`${name}: ${(bytes / 1000).toFixed(0)} kB gzipped`);
}
