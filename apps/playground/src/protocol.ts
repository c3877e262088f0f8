// The messages of docs/protocol.md, as types and as a decoder of the binary ones.

export interface DemoSummary { id: string; title: string; summary: string; group: string; chapter: string; dimension: number }
export interface Parameter {
  name: string; label: string; unit: string; display_unit: string; display_factor: number; display_offset: number;
  description: string; minimum: number; maximum: number; step: number; value: number; live: boolean; choices?: string[];
}
export interface Axis { label: string; unit: string }
export interface Series { name: string; style: 'line' | 'points'; color?: string; latest?: boolean; points?: [number, number][] }
export interface PlotDeclaration { title: string; x: Axis; y: Axis; series: Series[] }
export interface Camera { position: number[]; target: number[]; field_of_view?: number; height?: number; width?: number; follow?: number }
export interface Input { action: string; label: string; keys: string[]; kind: 'hold' | 'press'; value: number }
export interface Opened {
  type: 'opened'; demo: string; title: string; summary: string; text: string; dimension: 2 | 3; dt: number; camera: Camera;
  parameters: Parameter[]; plots: PlotDeclaration[]; inputs: Input[];
}
export interface Shape {
  kind: string; local: number[]; radius?: number; rounding?: number; half_length?: number; half_height?: number; half_extents?: number[]; radii?: number[];
  normal?: number[]; mesh?: number; points?: number[][]; loop?: boolean;
  color?: string; opacity?: number; sensor?: boolean;
}
export interface Body {
  id: number; name: string; type: 'fixed' | 'kinematic' | 'dynamic'; color?: string; position: number[]; rotation: number[];
  shapes: Shape[];
}
export interface Numbers {
  type: 'numbers'; stages: Record<string, number>; mass: number; momentum: number[]; angular_momentum: number[]; joint_error: number;
  hand_force: number; bytes: number; arrows: {velocity: number; force: number; impulse: number};
  legend: LegendEntry[];
}
export interface Layer { name: string; label: string; legend: string }
export interface LegendEntry { label: string; color: string }
export interface Verified {
  type: 'verified'; done: boolean; equal: boolean; step: number; first: number; last: number; frames: number; hashes: number; message: string; differs?: number;
}
export interface Probed { type: 'probed'; kind: string; body: number; point: number[]; normal: number[]; distance: number }
export interface Inspected {
  type: 'inspected'; body: number; name: string; kind: string; mass: number; weight: number; position: number[]; velocity: number[];
  angular_velocity: number[]; awake: boolean; why: string; advice: string[];
  contacts: {with: string; points: number; normal: number[]; impulse: number; friction: number; depth: number; color: number}[];
  joints: {type: string; with: string; force: number; torque: number; error: number; direct: boolean}[];
}
export type HostMessage =
  | {type: 'welcome'; protocol: number; version: string; engine: string; demos: DemoSummary[]; layers: Layer[]}
  | Opened
  | Verified
  | {type: 'scene'; bodies: Body[]; ground?: {level: number}}
  | {type: 'bodies'; add: Body[]; remove: number[]}
  | {type: 'grabbed'; pointer: number; body: number; point: number[]}
  | {type: 'status'; running: boolean; speed: number; time: number; step: number; first: number; last: number; recording: boolean; playing?: boolean; message?: string}
  | Probed
  | Numbers
  | Inspected
  | {type: 'source'; name: string; text: string; written?: boolean}
  | {type: 'values'; values: Record<string, number>}
  | {type: 'error'; message: string};

export interface Mesh { kind: 'mesh'; id: number; positions: Float32Array; indices: Uint32Array }
export interface Stats {
  bodies: number; awake: number; contacts: number; joints: number; islands: number; threads: number; stepMs: number;
  realTimeFactor: number; kinetic: number; potential: number; hash: string; penetration: number;
}
export interface Frame {
  kind: 'frame'; key: boolean; dimension: number; sequence: number; step: number; time: number; origin: [number, number, number];
  /** Views into the message: body i has id ids(i), position and rotation below. */
  count: number; bodies: DataView; samples: {plot: number; series: number; x: number; y: number}[];
  lines: Float32Array; lineColors: Uint32Array; stats?: Stats;
}

/** Small balls: positions and radii as parts (0 … 65535) of a box and of the largest radius. */
export interface Points {
  kind: 'points'; count: number; low: number[]; size: number[]; radius: number;
  /** Per point four 16-bit numbers: x, y, z, radius. */
  places: Uint16Array; colors: Uint8Array;
}
/** Corners of triangles that move; `triangles` only where they changed. */
export interface Surface { kind: 'surface'; id: number; rgba: number; corners: Float32Array; triangles?: Uint32Array }

export const BODY_BYTES = 24;
const HEADER_BYTES = 56, SAMPLE_BYTES = 20, LINE_BYTES = 28, STATS_BYTES = 64;

/** Decodes one binary message, or throws with what was wrong: a page must never draw half a frame. */
export function decode(buffer: ArrayBuffer): Mesh | Frame | Points | Surface | {kind: 'file'; bytes: ArrayBuffer} {
  const view = new DataView(buffer);
  if (view.byteLength < 16) throw new Error(`message of ${view.byteLength} bytes, expected at least 16`);
  const kind = view.getUint8(0);
  if (kind === 1) {
    const vertices = view.getUint32(8, true), indices = view.getUint32(12, true);
    const expected = 16 + 12 * vertices + 4 * indices;
    if (view.byteLength !== expected) throw new Error(`mesh of ${view.byteLength} bytes, expected ${expected}`);
    return {kind: 'mesh', id: view.getUint32(4, true), positions: new Float32Array(buffer, 16, 3 * vertices),
      indices: new Uint32Array(buffer, 16 + 12 * vertices, indices)};
  }
  if (kind === 4) return decodePoints(view);
  if (kind === 5) return decodeSurface(buffer, view);
  if (kind === 3) return {kind: 'file', bytes: buffer.slice(4)};
  if (kind !== 2) throw new Error(`message of unknown kind ${kind}`);
  if (view.byteLength < HEADER_BYTES) throw new Error(`frame of ${view.byteLength} bytes has no whole header`);
  const flags = view.getUint8(1), count = view.getUint32(12, true), samples = view.getUint32(16, true), lines = view.getUint32(20, true);
  const expected = HEADER_BYTES + BODY_BYTES * count + SAMPLE_BYTES * samples + LINE_BYTES * lines + (flags & 2 ? STATS_BYTES : 0);
  if (view.byteLength !== expected) throw new Error(`frame of ${view.byteLength} bytes, expected ${expected}`);
  let at = HEADER_BYTES;
  const bodies = new DataView(buffer, at, BODY_BYTES * count);
  at += BODY_BYTES * count;
  const frame: Frame = {
    kind: 'frame', key: (flags & 1) !== 0, dimension: view.getUint16(2, true), sequence: view.getUint32(4, true),
    step: view.getUint32(8, true), time: view.getFloat64(24, true),
    origin: [view.getFloat64(32, true), view.getFloat64(40, true), view.getFloat64(48, true)], count, bodies, samples: [],
    lines: new Float32Array(6 * lines), lineColors: new Uint32Array(lines),
  };
  for (let i = 0; i < samples; ++i, at += SAMPLE_BYTES)
    frame.samples.push({plot: view.getUint16(at, true), series: view.getUint16(at + 2, true), x: view.getFloat64(at + 4, true), y: view.getFloat64(at + 12, true)});
  for (let i = 0; i < lines; ++i, at += LINE_BYTES) {
    for (let k = 0; k < 6; ++k) frame.lines[6 * i + k] = view.getFloat32(at + 4 * k, true);
    frame.lineColors[i] = view.getUint32(at + 24, true);
  }
  if (flags & 2) {
    const u = (k: number) => view.getUint32(at + k, true);
    frame.stats = {
      bodies: u(0), awake: u(4), contacts: u(8), joints: u(12), islands: u(16), threads: u(20), stepMs: view.getFloat32(at + 24, true),
      realTimeFactor: view.getFloat32(at + 28, true), kinetic: view.getFloat64(at + 32, true), potential: view.getFloat64(at + 40, true),
      hash: view.getBigUint64(at + 48, true).toString(16).padStart(16, '0'), penetration: view.getFloat64(at + 56, true),
    };
  }
  return frame;
}

const POINTS_HEADER = 36, POINT_BYTES = 12;
function decodePoints(view: DataView): Points {
  const count = view.getUint32(4, true), expected = POINTS_HEADER + POINT_BYTES * count;
  if (view.byteLength !== expected) throw new Error(`points of ${view.byteLength} bytes, expected ${expected}`);
  const three = (at: number) => [view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true)];
  const places = new Uint16Array(4 * count), colors = new Uint8Array(4 * count);
  for (let i = 0, at = POINTS_HEADER; i < count; ++i, at += POINT_BYTES) {
    for (let k = 0; k < 4; ++k) places[4 * i + k] = view.getUint16(at + 2 * k, true);
    const rgba = view.getUint32(at + 8, true);
    colors[4 * i] = rgba >>> 24;
    colors[4 * i + 1] = rgba >>> 16 & 255;
    colors[4 * i + 2] = rgba >>> 8 & 255;
    colors[4 * i + 3] = rgba & 255;
  }
  return {kind: 'points', count, low: three(8), size: three(20), radius: view.getFloat32(32, true), places, colors};
}

function decodeSurface(buffer: ArrayBuffer, view: DataView): Surface {
  if (view.byteLength < 20) throw new Error(`surface of ${view.byteLength} bytes has no whole header`);
  const corners = view.getUint32(8, true), indices = view.getUint32(12, true), expected = 20 + 12 * corners + 4 * indices;
  if (view.byteLength !== expected) throw new Error(`surface of ${view.byteLength} bytes, expected ${expected}`);
  return {
    kind: 'surface', id: view.getUint32(4, true), rgba: view.getUint32(16, true), corners: new Float32Array(buffer, 20, 3 * corners),
    triangles: view.getUint8(1) & 1 ? new Uint32Array(buffer, 20 + 12 * corners, indices) : undefined,
  };
}
