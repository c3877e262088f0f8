// Bundles the page into dist/: one script, one style sheet, one document.
import {build} from 'esbuild';
import {cpSync, mkdirSync, rmSync} from 'node:fs';

rmSync('dist', {recursive: true, force: true});
mkdirSync('dist', {recursive: true});
await build({
  entryPoints: {main: 'src/main.ts', style: 'src/style.css'},
  bundle: true,
  minify: true,
  sourcemap: false,
  format: 'esm',
  target: ['es2021'],
  outdir: 'dist',
  legalComments: 'linked',
});
for (const file of ['index.html', 'icon.svg']) cpSync(`src/${file}`, `dist/${file}`);
