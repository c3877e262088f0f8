// Cameras are declared for a picture of 16 by 9. A narrower one shows the same bodies: the camera steps back just as far
// as they need, and no further than the whole width of the wide picture needs.
import * as THREE from 'three';
import type {Camera} from './protocol';

export interface Seen { position: THREE.Vector3; reach: number }
const WIDE = 16 / 9, MARGIN = 0.94;
const vector = (p: number[]) => new THREE.Vector3(p[0], p[1], p[2]);

/** How many times further than declared a camera of space must stand. */
export function stepBack(camera: Camera, aspect: number, bodies: Iterable<Seen>): number {
  const away = vector(camera.position).sub(vector(camera.target)), distance = away.length();
  const half = Math.tan((camera.field_of_view ?? 0.8) / 2);
  const narrow = MARGIN * half * aspect;
  let factor = camera.width ? camera.width / 2 / narrow / distance : 1;
  if (aspect >= WIDE) return Math.max(1, factor);
  const forward = away.clone().divideScalar(-distance), right = forward.clone().cross(new THREE.Vector3(0, 1, 0)).normalize(), from = vector(camera.position);
  factor = Math.max(1, factor, 1.1 / aspect);  // particles, water and lines are not asked for one by one
  const most = Math.max(factor, WIDE / aspect);
  for (const {position, reach} of bodies) {
    if (reach > distance) continue;  // the land
    const to = position.clone().sub(from), depth = to.dot(forward), aside = Math.abs(to.dot(right));
    if (depth <= 0 || aside > depth * half * WIDE) continue;
    factor = Math.max(factor, 1 + ((aside + reach) / narrow - depth) / distance);
  }
  return Math.min(most, factor);
}

/** Metres from bottom to top that a camera of the plane must show. */
export function widened(camera: Camera, aspect: number, bodies: Iterable<Seen>): number {
  const declared = camera.height ?? 20;
  let height = Math.max(declared, (camera.width ?? 0) / aspect);
  if (aspect >= WIDE) return height;
  const most = Math.max(height, declared * WIDE / aspect);
  for (const {position, reach} of bodies) {
    const aside = Math.abs(position.x - camera.target[0]);
    if (reach > declared * WIDE || aside > declared * WIDE / 2) continue;
    height = Math.max(height, 2 * (aside + reach) / MARGIN / aspect);
  }
  return Math.min(most, height);
}
