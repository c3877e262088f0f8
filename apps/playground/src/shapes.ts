// Drawable geometry for every shape of the protocol. Shapes that differ only by scale share one instanced geometry.
import * as THREE from 'three';
import {RoundedBoxGeometry} from 'three/addons/geometries/RoundedBoxGeometry.js';
import type {Mesh, Shape} from './protocol';

export interface Drawable {
  key: string;
  scale: THREE.Vector3;
  /** `fine` is 1 for a few bodies and less for thousands: how finely round shapes are cut. */
  build: (fine: number) => THREE.BufferGeometry;
}

/** How far a shape reaches from its body's origin, metres; infinite for planes, unknown (0) for meshes. */
export function reachOf(shape: Shape): number {
  if (shape.kind === 'plane') return Infinity;
  const own = Math.max(...[shape.half_extents, shape.radii].map((v) => (v ? Math.hypot(...v) : 0)), shape.half_length ?? 0, shape.half_height ?? 0,
    ...(shape.points ?? []).map((p) => Math.hypot(p[0], p[1])));
  return Math.hypot(shape.local[0], shape.local[1], shape.local[2]) + own + (shape.radius ?? 0);
}

const cut = (n: number, fine: number) => Math.max(6, Math.round(n * fine));

const one = () => new THREE.Vector3(1, 1, 1);

/** Vertex colours by a pattern, so that one sees a round body turn. */
function tint(geometry: THREE.BufferGeometry, shade: (x: number, y: number, z: number) => number): THREE.BufferGeometry {
  const position = geometry.getAttribute('position');
  const colors = new Float32Array(3 * position.count);
  for (let i = 0; i < position.count; ++i) colors.fill(shade(position.getX(i), position.getY(i), position.getZ(i)), 3 * i, 3 * i + 3);
  geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
  return geometry;
}
const plain = (geometry: THREE.BufferGeometry) => tint(geometry, () => 1);
function quartered(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  const position = flat.getAttribute('position');
  const colors = new Float32Array(3 * position.count);
  for (let i = 0; i < position.count; i += 3) {
    const mean = (k: 'getX' | 'getY' | 'getZ') => position[k](i) + position[k](i + 1) + position[k](i + 2);
    const value = mean('getX') * mean('getZ') > 0 ? 1 : 0.68;
    colors.fill(value, 3 * i, 3 * i + 9);
  }
  flat.setAttribute('color', new THREE.BufferAttribute(colors, 3));
  return flat;
}

export function drawable3(shape: Shape, meshes: Map<number, Mesh>): Drawable | undefined {
  const r = shape.radius ?? 0, h = shape.half_length ?? shape.half_height ?? 0;
  switch (shape.kind) {
    case 'sphere':
      return {key: 'sphere', scale: new THREE.Vector3(r, r, r), build: (fine) => quartered(new THREE.SphereGeometry(1, cut(32, fine), cut(20, fine)))};
    case 'ellipsoid': {
      const [x, y, z] = shape.radii!;
      return {key: 'sphere', scale: new THREE.Vector3(x, y, z), build: (fine) => quartered(new THREE.SphereGeometry(1, cut(32, fine), cut(20, fine)))};
    }
    case 'box': {
      const [x, y, z] = shape.half_extents!;
      if (r === 0) return {key: 'box', scale: new THREE.Vector3(2 * x, 2 * y, 2 * z), build: () => plain(new THREE.BoxGeometry(1, 1, 1))};
      return {key: `rounded ${x} ${y} ${z} ${r}`, scale: one(), build: () => plain(new RoundedBoxGeometry(2 * (x + r), 2 * (y + r), 2 * (z + r), 3, r))};
    }
    case 'capsule':
      return {key: `capsule ${(h / r).toFixed(3)}`, scale: new THREE.Vector3(r, r, r), build: (fine) => quartered(new THREE.CapsuleGeometry(1, 2 * h / r, Math.max(3, Math.round(8 * fine)), cut(24, fine)))};
    case 'cylinder':
      if (shape.rounding) {
        const e = shape.rounding;
        return {key: `rounded cylinder ${r} ${h} ${e}`, scale: one(), build: (fine) => {
          const steps = Math.max(2, Math.round(6 * fine));
          const rim = (from: number, y: number) => Array.from({length: steps + 1}, (_, i) => {
            const a = from + 0.5 * Math.PI * i / steps;
            return new THREE.Vector2(r + e * Math.cos(a), y + e * Math.sin(a));
          });
          const profile = [new THREE.Vector2(0, -h - e), ...rim(-0.5 * Math.PI, -h), ...rim(0, h), new THREE.Vector2(0, h + e)];
          return quartered(new THREE.LatheGeometry(profile, cut(40, fine)));
        }};
      }
      return {key: 'cylinder', scale: new THREE.Vector3(r, 2 * h, r), build: (fine) => quartered(new THREE.CylinderGeometry(1, 1, 1, cut(40, fine)))};
    case 'cone':
      if (shape.rounding) {
        const e = shape.rounding;
        return {key: `rounded cone ${r} ${h} ${e}`, scale: one(), build: (fine) => {
          const steps = Math.max(2, Math.round(6 * fine)), side = Math.atan2(r, 2 * h);
          const arc = (x: number, y: number, from: number, to: number) => Array.from({length: steps + 1}, (_, i) => {
            const a = from + (to - from) * i / steps;
            return new THREE.Vector2(Math.max(0, x + e * Math.cos(a)), y + e * Math.sin(a));
          });
          const profile = [new THREE.Vector2(0, -h - e), ...arc(r, -h, -0.5 * Math.PI, side), ...arc(0, h, side, 0.5 * Math.PI)];
          return quartered(new THREE.LatheGeometry(profile, cut(40, fine)));
        }};
      }
      return {key: 'cone', scale: new THREE.Vector3(r, 2 * h, r), build: (fine) => quartered(new THREE.ConeGeometry(1, 1, cut(40, fine)))};
    case 'mesh': {
      const mesh = meshes.get(shape.mesh!);
      if (!mesh) return undefined;
      return {key: `mesh ${mesh.id}`, scale: one(), build: () => {
        const indexed = new THREE.BufferGeometry();
        indexed.setAttribute('position', new THREE.BufferAttribute(mesh.positions, 3));
        indexed.setIndex(new THREE.BufferAttribute(mesh.indices, 1));
        const flat = indexed.toNonIndexed();
        flat.computeVertexNormals();
        return plain(flat);
      }};
    }
    default: return undefined;
  }
}

/** The outline of a convex shape of the plane, counterclockwise. */
function outline(shape: Shape): THREE.Vector2[] {
  const arc = (cx: number, cy: number, r: number, from: number, to: number, steps: number) =>
    Array.from({length: steps + 1}, (_, i) => {
      const a = from + (to - from) * i / steps;
      return new THREE.Vector2(cx + r * Math.cos(a), cy + r * Math.sin(a));
    });
  const r = shape.radius ?? 0;
  if (shape.kind === 'circle') return arc(0, 0, r, 0, 2 * Math.PI, 48).slice(0, -1);
  if (shape.kind === 'capsule') {
    const h = shape.half_length!;
    return [...arc(0, h, r, 0, Math.PI, 16), ...arc(0, -h, r, Math.PI, 2 * Math.PI, 16)];
  }
  const points = shape.points!.map(([x, y]) => new THREE.Vector2(x, y));
  if (r === 0) return points;
  return points.flatMap((p, i) => {
    const before = points[(i + points.length - 1) % points.length], after = points[(i + 1) % points.length];
    const from = Math.atan2(-(p.x - before.x), p.y - before.y);
    let to = Math.atan2(-(after.x - p.x), after.y - p.y);
    while (to < from) to += 2 * Math.PI;
    return arc(p.x, p.y, r, from, to, 6);
  });
}

/** A filled outline with a darker border of `border` metres; circles get a spoke, so that one sees them turn. */
function filled(points: THREE.Vector2[], border: number, spoke: boolean): THREE.BufferGeometry {
  const positions: number[] = [], colors: number[] = [];
  const center = points.reduce((sum, p) => sum.add(p), new THREE.Vector2()).divideScalar(points.length);
  const triangle = (a: THREE.Vector2, b: THREE.Vector2, c: THREE.Vector2, shade: number, z = 0) => {
    for (const p of [a, b, c]) positions.push(p.x, p.y, z), colors.push(shade, shade, shade);
  };
  const inset = points.map((p) => {
    const d = p.clone().sub(center);
    const l = d.length();
    return center.clone().add(d.multiplyScalar(Math.max(0, 1 - border / Math.max(l, 1e-6))));
  });
  points.forEach((p, i) => {
    const j = (i + 1) % points.length;
    triangle(center, inset[i], inset[j], 1);
    triangle(inset[i], p, points[j], 0.55);
    triangle(inset[i], points[j], inset[j], 0.55);
  });
  if (spoke) {
    const r = points[0].distanceTo(center), w = border / 2;
    triangle(new THREE.Vector2(0, -w), new THREE.Vector2(r, -w), new THREE.Vector2(r, w), 0.55, 0.001);
    triangle(new THREE.Vector2(0, -w), new THREE.Vector2(r, w), new THREE.Vector2(0, w), 0.55, 0.001);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
  return geometry;
}

/** A band of the given width along a line. */
function band(points: THREE.Vector2[], loop: boolean, width: number): THREE.BufferGeometry {
  const positions: number[] = [];
  const last = loop ? points.length : points.length - 1;
  for (let i = 0; i < last; ++i) {
    const a = points[i], b = points[(i + 1) % points.length];
    const t = b.clone().sub(a).normalize().multiplyScalar(width / 2);
    const n = new THREE.Vector2(-t.y, t.x);
    const corners = [a.clone().sub(t).add(n), a.clone().sub(t).sub(n), b.clone().add(t).sub(n), b.clone().add(t).add(n)];
    for (const k of [0, 1, 2, 0, 2, 3]) positions.push(corners[k].x, corners[k].y, 0);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  return plain(geometry);
}

export function drawable2(shape: Shape, pixel: number): Drawable | undefined {
  if (shape.kind === 'segment' || shape.kind === 'chain') {
    const points = shape.points!.map(([x, y]) => new THREE.Vector2(x, y));
    return {key: `band ${JSON.stringify(shape.points)} ${shape.loop}`, scale: one(), build: () => band(points, shape.loop ?? false, 3 * pixel)};
  }
  if (!['circle', 'capsule', 'polygon'].includes(shape.kind)) return undefined;
  const key = shape.kind === 'polygon' ? JSON.stringify([shape.points, shape.radius]) : `${shape.kind} ${shape.radius} ${shape.half_length}`;
  return {key, scale: one(), build: () => filled(outline(shape), 2.5 * pixel, shape.kind === 'circle')};
}
