// A rocket motor of one's own as a scene: every motor of a RASP thrust file (.eng) lifts a model rocket made to its size.

export interface Motor { name: string; diameter: number; length: number; propellant: number; mass: number; curve: [time: number, thrust: number][] }

const MOST_ROCKETS = 6;

/** m, kg, s, N. Throws with the line, what was found there and what was expected, as the engine's reader does. */
export function readMotors(file: string, text: string): Motor[] {
  const motors: Motor[] = [];
  let motor: Motor | undefined;
  const wrong = (line: number, found: string, expected: string): never => { throw new Error(`${file}:${line}: found ${found}, expected ${expected}`); };
  const number = (word: string) => /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(word) ? Number(word) : NaN;
  const lines = text.replace(/^\uFEFF/, '').split('\n');
  lines.forEach((whole, index) => {
    const line = index + 1, words = whole.split(';')[0].trim().split(/\s+/).filter((word) => word !== '');
    if (words.length === 0) return;
    // A thrust of 0 ends a motor, but measured curves touch it between, too: what follows tells.
    if (motor && motor.curve.length > 1 && motor.curve[motor.curve.length - 1][1] === 0 && words.length !== 2) motor = undefined;
    if (!motor) {
      if (words.length < 7) wrong(line, `${words.length} words`, 'the header of a motor: name, diameter, length, delays, propellant mass, mass, manufacturer');
      const value = (word: string, what: string) => {
        const x = number(word);
        return x > 0 && Number.isFinite(x) ? x : wrong(line, `"${word}"`, what);
      };
      motor = {
        name: words[0], diameter: 1e-3 * value(words[1], 'a diameter in mm > 0'), length: 1e-3 * value(words[2], 'a length in mm > 0'),
        propellant: value(words[4], 'a propellant mass in kg > 0'), mass: value(words[5], 'a mass in kg > 0'), curve: [],
      };
      if (motor.propellant > motor.mass) wrong(line, `${motor.propellant} kg of propellant`, `at most the motor's mass of ${motor.mass} kg`);
      for (const delay of words[3].split(/[-,]/))
        if (!/^p$/i.test(delay) && !(number(delay) >= 0)) wrong(line, `"${delay}"`, 'delays in s separated by dashes, or P for plugged');
      motors.push(motor);
      return;
    }
    const time = number(words[0]), thrust = words.length === 2 ? number(words[1]) : NaN;
    if (!Number.isFinite(time) || !Number.isFinite(thrust)) wrong(line, `"${words.length === 2 && Number.isFinite(time) ? words[1] : words[0]}"`, 'a time in s and a thrust in N');
    const last = motor.curve[motor.curve.length - 1];
    if (time < 0 || (last && time <= last[0])) wrong(line, `the time ${time}`, 'times that rise from 0');
    if (thrust < 0) wrong(line, `the thrust ${thrust}`, 'a thrust >= 0');
    motor.curve.push([time, thrust]);
  });
  const last = motors[motors.length - 1];
  if (last && !(last.curve.length > 1 && last.curve[last.curve.length - 1][1] === 0)) wrong(lines.length, 'the end of the file', "the motor's last line, with thrust 0");
  if (motors.length === 0) wrong(lines.length, 'no motor', 'at least one');
  for (const one of motors) if (!(impulse(one) > 0)) throw new Error(`${file}: the motor ${one.name} has no thrust`);
  return motors;
}

/** N·s; lines between the points, from no thrust at time 0 on. */
export function impulse(motor: Motor): number {
  let sum = 0.5 * motor.curve[0][0] * motor.curve[0][1];
  for (let i = 1; i < motor.curve.length; ++i) sum += 0.5 * (motor.curve[i][0] - motor.curve[i - 1][0]) * (motor.curve[i][1] + motor.curve[i - 1][1]);
  return sum;
}

/** The text of a scene. Throws with what is wrong with the file. */
export function sceneOfMotors(file: string, text: string): string {
  const all = readMotors(file, text), motors = all.slice(0, MOST_ROCKETS), round = (x: number) => Number(x.toPrecision(6));
  const names: string[] = [];
  for (const motor of motors) {
    const plain = motor.name.replace(/\W/g, '_').replace(/^(?=\d)/, '_');
    names.push(names.includes(plain) ? `${plain}_${names.length + 1}` : plain);
  }
  const apart = Math.max(0.4, 6 * Math.max(...motors.map((motor) => motor.diameter)));
  // A tube that holds the motor, as heavy as lets it leave at eight times its weight, fins in proportion, and a
  // parachute that brings it down at 5 m/s: class values of hobby rockets.
  const rockets = motors.map((motor, i) => {
    const burn = motor.curve[motor.curve.length - 1][0], width = motor.diameter + 0.007, length = Math.max(24 * width, 3 * motor.length);
    const dry = Math.max(0.5 * motor.mass, impulse(motor) / burn / (8 * 9.80665) - motor.mass), landing = dry + motor.mass - motor.propellant;
    return {
      name: names[i], position: [round((i - (motors.length - 1) / 2) * apart), '5 cm', 0], direction: ['=sin(tilt)', '=cos(tilt)', 0], rail_length: round(Math.max(1.2, 1.5 * length)), start: '1 s',
      color: ['#d84a2a', '#2a6fd8', '#2a9d6a', '#8a4ad8', '#d8a02a', '#5a6470'][i], trail: true,
      diameter: round(width), length: round(length), nose_length: round(4 * width), drag_coefficient: 0.55,
      fin_count: 4, fin_root_chord: round(3.2 * width), fin_tip_chord: round(2 * width), fin_span: round(2.4 * width), fin_sweep: round(1.2 * width), fin_position: round(length - 3.3 * width),
      parachute_drag_area: round(2 * landing * 9.80665 / (1.225 * 25)), parachute_delay: '0.5 s',
      stages: [{
        motor: {propellant_mass: motor.propellant, mass: motor.mass, thrust: motor.curve.flat()},
        dry_mass: `=load*${round(dry)} kg`, dry_centre: round(0.45 * length), motor_centre: round(length - motor.length / 2),
      }],
    };
  });
  const told = all.length > motors.length ? `The first ${motors.length} of the ${all.length} motors` : motors.length > 1 ? `The ${motors.length} motors` : `The motor ${motors[0].name}`;
  const series = (quantity: (name: string) => string) => names.map((name, i) => ({name: motors[i].name, quantity: quantity(name)}));
  return JSON.stringify({
    name: `${file} flies`,
    description: `${told} of ${file}, each in a model rocket made to its size: ${motors.map((motor) => `${motor.name} ${impulse(motor).toPrecision(3)} N s`).join(', ')}. Masses, fins and parachutes are class values of hobby rockets.`,
    dimension: 3, step: '1/120 s', duration: '40 s', ground: 0,
    parameters: {
      load: {value: 1, minimum: 0.5, maximum: 4, step: 0.1, description: 'how many times the mass of the empty rocket'},
      wind: {value: '2 m/s', minimum: '0 m/s', maximum: '8 m/s', description: 'from the left'},
      tilt: {value: '0 deg', minimum: '-20 deg', maximum: '20 deg', description: 'of the rails, with the wind'},
    },
    environment: {wind: {velocity: ['=wind', 0, 0]}},
    bodies: [{name: 'ground', type: 'fixed', shape: {type: 'plane', normal: [0, 1, 0]}}],
    rockets,
    camera: {position: [round(apart * motors.length / 2), round(0.8 * rockets[0].length), round(2.5 * rockets[0].length + apart * motors.length)], target: [0, round(0.8 * rockets[0].length), 0], field_of_view: '45 deg', follow: names[0]},
    plots: [
      {title: 'Height', y: {label: 'height', unit: 'm'}, series: series((name) => `${name}.position.y`)},
      {title: 'Speed', y: {label: 'speed', unit: 'm/s'}, series: series((name) => `${name}.speed`)},
      {title: 'Thrust', y: {label: 'thrust', unit: 'N'}, series: series((name) => `rocket.${name}.thrust`)},
    ],
  }, (key, value) => key === 'thrust' || key === 'direction' || key === 'position' || key === 'target' ? `@${JSON.stringify(value)}@` : value, 1).replace(/"@(.*?)@"/g, (_, list: string) => list.replace(/\\"/g, '"'));
}
