// A mesh of one's own as a scene: what an OBJ, STL or glTF file holds falls on the ground and breaks.
import {BufferAttribute, BufferGeometry, Mesh, type Object3D} from 'three';
import {GLTFLoader} from 'three/addons/loaders/GLTFLoader.js';
import {OBJLoader} from 'three/addons/loaders/OBJLoader.js';
import {STLLoader} from 'three/addons/loaders/STLLoader.js';
import {mergeVertices} from 'three/addons/utils/BufferGeometryUtils.js';

const MOST_TRIANGLES = 40000;

function geometriesOf(root: Object3D): BufferGeometry[] {
  const found: BufferGeometry[] = [];
  root.updateMatrixWorld(true);
  root.traverse((child) => { if (child instanceof Mesh) found.push((child.geometry as BufferGeometry).clone().applyMatrix4(child.matrixWorld)); });
  return found;
}

async function read(name: string, bytes: ArrayBuffer): Promise<BufferGeometry[]> {
  const text = () => new TextDecoder().decode(bytes);
  if (/\.obj$/i.test(name)) return geometriesOf(new OBJLoader().parse(text()));
  if (/\.stl$/i.test(name)) return [new STLLoader().parse(bytes)];
  return geometriesOf((await new GLTFLoader().parseAsync(/\.gltf$/i.test(name) ? text() : bytes, '')).scene);
}

/** Corners of the same place are one, so that what is closed for the eye is closed for the engine. */
function weld(parts: BufferGeometry[]): {vertices: number[][]; indices: number[]} {
  const vertices: number[][] = [], indices: number[] = [];
  for (const part of parts) {
    const bare = new BufferGeometry();
    bare.setAttribute('position', new BufferAttribute(new Float32Array(part.getAttribute('position').array), 3));
    if (part.index) bare.setIndex(part.index);
    bare.computeBoundingSphere();
    const one = mergeVertices(bare, 1e-5 * (bare.boundingSphere?.radius ?? 1));
    const at = one.getAttribute('position'), first = vertices.length;
    for (let i = 0; i < at.count; ++i) vertices.push([at.getX(i), at.getY(i), at.getZ(i)]);
    const index = one.index?.array ?? [];
    for (let i = 0; i + 2 < index.length; i += 3)
      if (index[i] !== index[i + 1] && index[i] !== index[i + 2] && index[i + 1] !== index[i + 2]) indices.push(first + index[i], first + index[i + 1], first + index[i + 2]);
  }
  return {vertices, indices};
}

/** The text of a scene. Throws with what is wrong with the file. */
export async function sceneOfMesh(name: string, bytes: ArrayBuffer): Promise<string> {
  const {vertices, indices} = weld(await read(name, bytes));
  if (indices.length === 0) throw new Error(`${name}: found no triangles`);
  if (indices.length > 3 * MOST_TRIANGLES) throw new Error(`${name}: found ${indices.length / 3} triangles, expected at most ${MOST_TRIANGLES}`);
  const low = [0, 1, 2].map((k) => vertices.reduce((x, v) => Math.min(x, v[k]), Infinity));
  const high = [0, 1, 2].map((k) => vertices.reduce((x, v) => Math.max(x, v[k]), -Infinity));
  const size = Math.max(...[0, 1, 2].map((k) => high[k] - low[k]));
  if (!(size > 0 && Number.isFinite(size))) throw new Error(`${name}: the mesh has no size`);
  // A metre tall or wide, its lowest point at the origin's height: files come in any unit.
  const placed = vertices.map((v) => v.map((x, k) => Number(((x - (k === 1 ? low[1] : (low[k] + high[k]) / 2)) / size).toPrecision(6))));
  const tall = (high[1] - low[1]) / size;
  const scene = {
    name: `${name} breaks`,
    description: `${indices.length / 3} triangles from ${name}, a metre in size, cut into cells that hold together until it lands. The mesh must be closed.`,
    dimension: 3, step: '1/120 s', duration: '4 s', ground: '0 m',
    parameters: {
      pieces: {value: 60, minimum: 4, maximum: 300, step: 1, description: 'cells that it is cut into'},
      height: {value: '1 m', minimum: '0.01 m', maximum: '10 m', description: 'of its fall'},
      strength: {value: '0.5 MPa', minimum: '0.01 MPa', maximum: '50 MPa', description: 'of its bonds in tension and shear'},
      seed: {value: 1, minimum: 1, maximum: 100, step: 1, description: 'of the cells'},
    },
    bodies: [{name: 'ground', type: 'fixed', shape: {type: 'plane', normal: [0, 1, 0], material: {friction: 0.6}}}],
    structures: [{
      name: 'mesh', position: [0, '=height', 0], pattern: 'even', pieces: '=pieces', seed: '=seed', substance: 'ceramic',
      tensile_strength: '=strength', shear_strength: '=strength', material: {friction: 0.5}, color: '#d9b38c',
      shape: {type: 'mesh', vertices: placed, indices},
    }],
    camera: {position: [1.6, 1.1 + tall / 2, 2.6], target: [0, 0.3 + tall / 3, 0], field_of_view: '45 deg'},
    plots: [{title: 'Pieces', series: [{name: 'bodies', quantity: 'structure.mesh.pieces'}, {name: 'broken bonds', quantity: 'structure.mesh.broken'}]}],
  };
  // One line a key; the long lists in one line each.
  return JSON.stringify(scene, (key, value) => key === 'vertices' || key === 'indices' ? `@${JSON.stringify(value)}@` : value, 1).replace(/"@(.*?)@"/g, '$1');
}
