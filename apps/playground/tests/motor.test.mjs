// Thrust files without a browser: what src/motor.ts makes of them is a scene that the engine flies, and errors name lines.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {after, test} from 'node:test';
import {fileURLToPath, pathToFileURL} from 'node:url';
import {build} from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url)), root = join(here, '../../..');
const carom = process.env.CAROM ?? join(root, 'build/release/apps/command/carom');
const folder = mkdtempSync(join(tmpdir(), 'carom-motor-'));
after(() => rmSync(folder, {recursive: true}));
await build({entryPoints: [join(here, '../src/motor.ts')], bundle: true, format: 'esm', outfile: join(folder, 'motor.mjs'), logLevel: 'error'});
const {impulse, readMotors, sceneOfMotors} = await import(pathToFileURL(join(folder, 'motor.mjs')).href);
const files = readdirSync(join(root, 'presets/motor')).filter((name) => name.endsWith('.eng'));
const run = (scene) => JSON.parse(execFileSync(carom, ['run', scene, '--json', '--no-record', '--no-pictures', '--out', join(folder, 'out')], {encoding: 'utf8'}));

test('the total impulse is that of the certificates', () => {
  const motors = readMotors('black_powder.eng', readFileSync(join(root, 'presets/motor/black_powder.eng'), 'utf8'));
  assert.deepEqual(motors.map((motor) => motor.name), ['A8', 'B6', 'C6', 'D12']);
  [2.32, 4.33, 8.82, 16.84].forEach((certified, i) => assert.ok(Math.abs(impulse(motors[i]) - certified) < 0.002 * certified, `${motors[i].name}: ${impulse(motors[i])}`));
});

for (const name of files)
  test(`${name} flies`, () => {
    const text = readFileSync(join(root, 'presets/motor', name), 'utf8'), scene = JSON.parse(sceneOfMotors(name, text));
    // Each rocket climbs, by the engine's own word.
    scene.expectations = scene.rockets.map((rocket) => ({quantity: `rocket.${rocket.name}.apex`, expected: '5000 m', tolerance: '4970 m', source: 'higher than 30 m'}));
    const file = join(folder, `${name}.json`);
    writeFileSync(file, JSON.stringify(scene));
    const report = run(file);
    assert.equal(report.expectations.length, Math.min(6, readMotors(name, text).length));
    for (const e of report.expectations) assert.ok(e.passed ?? e.ok, JSON.stringify(e));
  });

test('motors of the same name, or of names that are no words, are told apart', () => {
  const one = 'H128W-M 29 194 6 0.0935 0.2062 maker\n0.1 200\n1 0\n', scene = JSON.parse(sceneOfMotors('two.eng', one + one));
  assert.deepEqual(scene.rockets.map((rocket) => rocket.name), ['H128W_M', 'H128W_M_2']);
  writeFileSync(join(folder, 'two.json'), JSON.stringify({...scene, duration: '2 s'}));
  run(join(folder, 'two.json'));
});

test('errors name the file, the line, what was found and what was expected', () => {
  const head = 'M1 18 70 3-P 0.005 0.02 me\n', wrong = [
    ['', /^x\.eng:1: found no motor, expected at least one$/],
    ['; a comment\nM1 18 70 3\n', /^x\.eng:2: found 4 words, expected the header of a motor/],
    ['M1 0 70 3 0.005 0.02 me\n0.1 5\n0.2 0\n', /^x\.eng:1: found "0", expected a diameter in mm > 0$/],
    ['M1 18 70 soon 0.005 0.02 me\n0.1 5\n0.2 0\n', /^x\.eng:1: found "soon", expected delays in s/],
    ['M1 18 70 3 0.05 0.02 me\n0.1 5\n0.2 0\n', /^x\.eng:1: found 0\.05 kg of propellant, expected at most the motor's mass/],
    [`${head}0.1 5\n0.05 4\n0.2 0\n`, /^x\.eng:3: found the time 0\.05, expected times that rise from 0$/],
    [`${head}0.1 5N\n0.2 0\n`, /^x\.eng:2: found "5N", expected a time in s and a thrust in N$/],
    [`${head}0.1 -5\n0.2 0\n`, /^x\.eng:2: found the thrust -5, expected a thrust >= 0$/],
    [`${head}0.1 5\n0.2 4`, /^x\.eng:3: found the end of the file, expected the motor's last line, with thrust 0$/],
    [`${head}0.1 0\n0.2 0\n`, /^x\.eng: the motor M1 has no thrust$/],
  ];
  for (const [text, message] of wrong) assert.throws(() => sceneOfMotors('x.eng', text), {message});
});
