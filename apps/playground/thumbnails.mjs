// Pictures of every demo for the start page, drawn by `carom render` at build time. Kept in build/thumbnails by what they
// show, so that a build draws only what has changed.
import {execFile} from 'node:child_process';
import {createHash} from 'node:crypto';
import {copyFileSync, existsSync, mkdirSync, readFileSync, renameSync, rmSync} from 'node:fs';
import {availableParallelism} from 'node:os';
import {join} from 'node:path';
import {promisify} from 'node:util';

const SIZE = '400x250';

/** The file of a demo's picture: `scene:heap` is no name for one. */
export const pictureName = (id) => `${id.replace(/[^\w-]/g, '-')}.png`;

/** Draws the pictures of all demos into `out`/thumbnails; says which demos have one. Without the program: none. */
export async function thumbnails(root, out, sources) {
  const program = [process.env.CAROM, join(root, 'build/release/apps/command/carom'), join(root, 'build/apps/command/carom')].find((p) => p && existsSync(p));
  if (!program) {
    console.log('no pictures of the demos: the carom command has not been built');
    return [];
  }
  const run = (...rest) => promisify(execFile)(program, rest, {maxBuffer: 1 << 26, cwd: root});
  const started = performance.now(), cache = join(root, 'build/thumbnails'), folder = join(out, 'thumbnails');
  for (const needed of [cache, folder]) mkdirSync(needed, {recursive: true});
  // A scene file that cannot be read is told by the exit status; the others are listed all the same.
  const listed = JSON.parse((await run('list', '--json').catch((error) => error)).stdout);
  const drawing = ['picture', 'raster', 'tessellate'].map((name) => readFileSync(join(root, `apps/command/${name}.cpp`), 'utf8')).join('') + SIZE;
  const waiting = [
    ...listed.demos.map((d) => ({id: d.demo, declared: d, text: sources[d.demo]?.code ?? ''})),
    ...listed.stress.map((d) => ({id: d.demo, declared: d, text: '', moment: 0.3})),  // thousands of bodies: a few steps must do
    ...listed.scenes.filter((d) => d.demo).map((d) => ({id: `scene:${d.demo}`, declared: d, text: readFileSync(join(root, `scenes/${d.demo}.json`), 'utf8')})),
  ];
  const made = [];
  let drawn = 0;
  const draw = async () => {
    for (let next = waiting.shift(); next; next = waiting.shift()) {
      const {id, declared, text} = next, name = pictureName(id);
      const key = createHash('sha256').update(drawing).update(JSON.stringify(declared)).update(text).digest('hex').slice(0, 16);
      const kept = join(cache, `${key}-${name}`);
      if (!existsSync(kept)) {
        // Well under way, and early enough that something still happens.
        const moment = next.moment ?? Math.min(declared.duration, Math.max(0.5, Math.min(2.5, 0.3 * declared.duration))), scratch = join(cache, `${key}-frames`);
        try {
          await run('render', declared.demo, '--bare', '--quiet', '--threads', '1', '--size', SIZE, '--from', String(moment), '--to', String(moment), '--out', scratch);
        } catch (error) {
          console.log(`no picture of ${id}: ${String(error.stderr ?? error).trim()} (is ${program} up to date?)`);
          continue;
        }
        renameSync(join(scratch, 'frame-000000.png'), kept);
        rmSync(scratch, {recursive: true});
        ++drawn;
      }
      copyFileSync(kept, join(folder, name));
      made.push(id);
    }
  };
  await Promise.all(Array.from({length: availableParallelism()}, draw));
  console.log(`${made.length} pictures of demos, ${drawn} of them new, in ${((performance.now() - started) / 1000).toFixed(1)} s`);
  return made;
}
