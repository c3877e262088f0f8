// What moves without being a body: clouds of points, drawn as shaded discs that face the camera, and surfaces whose
// corners come anew with every frame (cloth, soft bodies, water).
import * as THREE from 'three';
import type {Points, Surface} from './protocol';

const vertex = `
  attribute vec4 place;   // x, y, z, radius: parts of the box and of the largest radius
  attribute vec4 tone;
  uniform vec3 low, size, shift;
  uniform float largest, pixels;
  varying vec4 shade;
  varying float reach;    // radius on the screen, pixels
  void main() {
    shade = vec4(pow(tone.rgb, vec3(2.2)), tone.a);  // colours come as the screen shows them
    vec4 seen = viewMatrix * vec4(low + size * place.xyz + shift, 1.0);
    gl_Position = projectionMatrix * seen;
    reach = max(0.75, place.w * largest * projectionMatrix[1][1] * pixels / gl_Position.w);
    gl_PointSize = min(2.0 * reach, 256.0);
  }`;
const fragment = `
  uniform vec3 sun;       // towards the light, in the camera's frame
  uniform float flatness; // 1 in the plane: no shading
  varying vec4 shade;
  varying float reach;
  void main() {
    vec2 p = 2.0 * gl_PointCoord - 1.0;
    float outside = dot(p, p);
    if (outside > 1.0) discard;
    vec3 normal = vec3(p.x, -p.y, sqrt(1.0 - outside));
    float light = mix(0.38 + 0.72 * max(0.0, dot(normal, sun)), 1.0, flatness);
    float edge = reach > 2.0 ? smoothstep(0.0, 3.0 / reach, 1.0 - outside) : 1.0;
    gl_FragColor = vec4(shade.rgb * light, shade.a * edge);
    #include <colorspace_fragment>
  }`;

export class Cloud {
  readonly object: THREE.Points;
  private material = new THREE.ShaderMaterial({
    vertexShader: vertex, fragmentShader: fragment, transparent: true,
    uniforms: {low: {value: new THREE.Vector3()}, size: {value: new THREE.Vector3()}, shift: {value: new THREE.Vector3()}, largest: {value: 0}, pixels: {value: 1}, sun: {value: new THREE.Vector3(0, 0, 1)}, flatness: {value: 0}},
  });
  private room = 0;

  constructor() {
    this.object = new THREE.Points(new THREE.BufferGeometry(), this.material);
    this.object.frustumCulled = false;
    this.object.visible = false;
  }

  set(points: Points, shift: THREE.Vector3, flat: boolean): void {
    this.object.visible = points.count > 0;
    if (points.count === 0) return;
    let geometry = this.object.geometry;  // without a `position`: three.js would count by it
    if (points.count > this.room) {
      // Grows by doubling: the GPU's buffers are made anew only then.
      this.room = Math.max(1024, 2 ** Math.ceil(Math.log2(points.count)));
      geometry.dispose();
      geometry = this.object.geometry = new THREE.BufferGeometry();
      geometry.setAttribute('place', new THREE.BufferAttribute(new Uint16Array(4 * this.room), 4, true).setUsage(THREE.DynamicDrawUsage));
      geometry.setAttribute('tone', new THREE.BufferAttribute(new Uint8Array(4 * this.room), 4, true).setUsage(THREE.DynamicDrawUsage));
    }
    const place = geometry.getAttribute('place') as THREE.BufferAttribute, tone = geometry.getAttribute('tone') as THREE.BufferAttribute;
    place.array.set(points.places);
    tone.array.set(points.colors);
    place.needsUpdate = tone.needsUpdate = true;
    geometry.setDrawRange(0, points.count);
    const u = this.material.uniforms;
    u.low.value.fromArray(points.low);
    u.size.value.fromArray(points.size);
    u.shift.value.copy(shift);
    u.largest.value = points.radius;
    u.flatness.value = flat ? 1 : 0;
    // What is solid hides what lies behind it; smoke does not.
    this.material.depthWrite = points.colors[3] > 250;
    this.material.depthTest = !flat;  // in the plane points lie over the bodies
    this.object.renderOrder = flat ? 1 : 0;
  }

  /** Before drawing: how many pixels a unit of the clip space's half height has, and where the light comes from. */
  view(camera: THREE.Camera, pixels: number, sun: THREE.Vector3): void {
    this.material.uniforms.pixels.value = pixels;
    this.material.uniforms.sun.value.copy(sun).transformDirection(camera.matrixWorldInverse);
  }

  clear(): void { this.object.visible = false; }
}

export class Surfaces {
  readonly group = new THREE.Group();
  private meshes = new Map<number, THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial | THREE.MeshBasicMaterial>>();

  set(surface: Surface, shift: THREE.Vector3, flat: boolean): void {
    let mesh = this.meshes.get(surface.id);
    if (!mesh) {
      if (!surface.triangles) return;  // its triangles come with the next key frame
      const opacity = (surface.rgba & 255) / 255;
      const look = {color: new THREE.Color(`#${(surface.rgba >>> 8).toString(16).padStart(6, '0')}`), side: THREE.DoubleSide, transparent: opacity < 1, opacity, depthWrite: opacity === 1};
      mesh = new THREE.Mesh(new THREE.BufferGeometry(), flat ? new THREE.MeshBasicMaterial(look) : new THREE.MeshStandardMaterial({...look, roughness: opacity < 1 ? 0.15 : 0.8}));
      mesh.castShadow = opacity === 1;
      mesh.receiveShadow = true;
      mesh.frustumCulled = false;
      this.meshes.set(surface.id, mesh);
      this.group.add(mesh);
    }
    const geometry = mesh.geometry, held = geometry.getAttribute('position') as THREE.BufferAttribute | undefined;
    if (held && held.count === surface.corners.length / 3) {
      held.array.set(surface.corners);
      held.needsUpdate = true;
    } else {
      geometry.dispose();
      geometry.setAttribute('position', new THREE.BufferAttribute(surface.corners.slice(), 3).setUsage(THREE.DynamicDrawUsage));
      geometry.deleteAttribute('normal');
    }
    if (surface.triangles) geometry.setIndex(new THREE.BufferAttribute(surface.triangles.slice(), 1));
    if (!flat) geometry.computeVertexNormals();
    mesh.position.copy(shift);
    if (flat) mesh.position.z -= 0.5;  // in the plane surfaces lie behind the bodies
  }

  clear(): void {
    for (const mesh of this.meshes.values()) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      this.group.remove(mesh);
    }
    this.meshes.clear();
  }
}
