// The light that comes from everywhere.
import * as THREE from 'three';

/**
 * Light from all around as spherical harmonics of a bright sky, a warm floor and a window on the left: what an
 * environment map would give surfaces as dull as these, without the second that its shaders take to compile.
 */
export function surroundings(): THREE.SphericalHarmonics3 {
  const light = new THREE.SphericalHarmonics3(), add = (i: number, r: number, g: number, b: number) => light.coefficients[i].add(new THREE.Vector3(r, g, b));
  add(0, 0.86, 0.9, 0.96);     // everywhere
  add(1, 0.2, 0.26, 0.36);     // y: the sky
  add(3, -0.1, -0.09, -0.06);  // x: the window
  add(2, 0.05, 0.05, 0.05);    // z: from behind the viewer
  add(6, -0.05, -0.05, -0.05);
  return light;
}
