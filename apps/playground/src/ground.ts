// The ground (3D) or the paper behind the plane (2D): a metric grid with labelled scale marks.
import * as THREE from 'three';

/** 1, 2 or 5 times a power of ten, near `length`. */
function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const digit = length / power;
  return (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10) * power;
}

/** The grid in the floor's own shader: lines one to two pixels wide at any distance, which fade where they would flicker. */
class Floor {
  private tones = {base: {value: new THREE.Color()}, weak: {value: new THREE.Color()}, strong: {value: new THREE.Color()}};
  private spacing = {value: 1};
  // What lies on the ground lies before it: the floor is drawn a little further away than it is.
  private material = new THREE.MeshLambertMaterial({transparent: true, polygonOffset: true, polygonOffsetFactor: 1.5, polygonOffsetUnits: 24});
  readonly mesh = new THREE.Mesh(new THREE.PlaneGeometry(1, 1).rotateX(-Math.PI / 2), this.material);

  constructor() {
    this.mesh.receiveShadow = true;
    this.mesh.renderOrder = -1;
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.tones, {spacing: this.spacing});
      shader.vertexShader = shader.vertexShader.replace('#include <common>', '#include <common>\nvarying vec2 place;')
        .replace('#include <begin_vertex>', '#include <begin_vertex>\nplace = (modelMatrix * vec4(position, 1.0)).xz;');
      shader.fragmentShader = shader.fragmentShader.replace('#include <common>', `#include <common>
        varying vec2 place;
        uniform vec3 base, weak, strong;
        uniform float spacing;
        float lines(vec2 p, float pixels) {
          vec2 step = max(fwidth(p), vec2(1e-6)), near = abs(fract(p - 0.5) - 0.5) / step;
          vec2 seen = clamp(0.5 * pixels + 0.5 - near, 0.0, 1.0) * clamp(1.5 - 3.0 * step, 0.0, 1.0);
          return max(seen.x, seen.y);
        }`).replace('#include <map_fragment>', `
        diffuseColor.rgb = mix(mix(base, weak, lines(place / spacing, 1.2)), strong, lines(place / (5.0 * spacing), 1.6));
        diffuseColor.a = 1.0 - smoothstep(40.0, 190.0, length(place) / spacing);`);
    };
  }
  set(dark: boolean, spacing: number, level: number): void {
    this.tones.base.value.set(dark ? '#26303c' : '#c9cdc9');
    this.tones.weak.value.set(dark ? '#3a4859' : '#aeb5af');
    this.tones.strong.value.set(dark ? '#55657a' : '#929b94');
    this.spacing.value = spacing;
    this.mesh.scale.setScalar(400 * spacing);
    this.mesh.position.y = level - 0.003 * spacing;  // below lawns and lanes that lie a finger's breadth too deep
  }
}

export class Ground {
  readonly group = new THREE.Group();
  private floor = new Floor();
  private marks = new THREE.Group();
  private dark = false;
  private spacing = 1;
  private level: number | undefined = 0;
  private plane?: {height: number; aspect: number; target: number[]};
  private kept = new Map<string, THREE.Material>();
  private stale = true;

  constructor() { this.group.add(this.floor.mesh, this.marks); }

  setTheme(dark: boolean): void { this.dark = dark; this.stale = true; }
  setScale(distance: number): void { this.spacing = roundLength(distance / 12); this.plane = undefined; this.stale = true; }
  showGround(level: number | undefined): void { this.level = level; this.plane = undefined; this.stale = true; }
  showPlane(height: number, aspect: number, target: number[]): void { this.plane = {height, aspect, target}; this.stale = true; }

  /** Before drawing from there: builds anew what has changed. */
  update(camera: THREE.Camera): void {
    this.build();
    // A label that lies before one's feet would fill the picture: it fades as one comes near.
    if (!this.plane) for (const mark of this.marks.children) {
      const shown = THREE.MathUtils.smoothstep(mark.position.distanceTo(camera.position) / this.spacing, 4.5, 8);
      ((mark as THREE.Mesh).material as THREE.Material).opacity = shown;
      mark.visible = shown > 0;
    }
  }

  private build(): void {
    if (!this.stale) return;
    this.stale = false;
    for (const child of [...this.marks.children]) {
      this.marks.remove(child);
      const {geometry, material} = child as THREE.Mesh<THREE.BufferGeometry, THREE.Material & {map?: THREE.Texture}>;
      geometry.dispose();
      material.map?.dispose();
      // One of each kind stays, and with it the compiled program that those of the next demo share.
      if (this.kept.has(material.type)) material.dispose(); else this.kept.set(material.type, material);
    }
    this.floor.mesh.visible = !this.plane && this.level !== undefined;
    if (this.plane) this.paper(this.plane.height, this.plane.aspect, this.plane.target);
    else if (this.level !== undefined) this.scale(this.level);
  }

  private scale(level: number): void {
    this.floor.set(this.dark, this.spacing, level);
    for (let i = -4; i <= 4; ++i) {
      if (i === 0) continue;
      const at = i * 5 * this.spacing;
      this.label(`${at} m`, new THREE.Vector3(at, level, 0.55 * this.spacing), 0.55 * this.spacing, true);
      this.label(`${at} m`, new THREE.Vector3(0.9 * this.spacing, level, at), 0.55 * this.spacing, true);
    }
  }

  private paper(height: number, aspect: number, target: number[]): void {
    const spacing = roundLength(height / 14), reach = Math.ceil(3 * height * Math.max(1, aspect) / spacing) * spacing;
    const x0 = Math.round(target[0] / spacing) * spacing, y0 = Math.round(target[1] / spacing) * spacing;
    for (const strong of [false, true]) {
      const points: number[] = [];
      for (let t = -reach; t <= reach + spacing / 2; t += spacing) {
        const isStrong = (v: number) => Math.round(v / spacing) % 5 === 0;
        if (isStrong(x0 + t) === strong) points.push(x0 + t, y0 - reach, -1, x0 + t, y0 + reach, -1);
        if (isStrong(y0 + t) === strong) points.push(x0 - reach, y0 + t, -1, x0 + reach, y0 + t, -1);
      }
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
      const color = this.dark ? (strong ? '#3b4a5c' : '#212b37') : (strong ? '#b4c0ca' : '#cfd9e1');
      this.marks.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color})));
    }
    for (let i = -6; i <= 6; ++i) {
      const at = (v: number) => Math.round(v / (5 * spacing)) * 5 * spacing + 5 * spacing * i;
      const x = at(x0), y = at(y0);
      this.label(`${Number(x.toPrecision(6))} m`, new THREE.Vector3(x, -0.6 * spacing, -0.5), 0.65 * spacing, false);
      if (y !== 0) this.label(`${Number(y.toPrecision(6))} m`, new THREE.Vector3(0.9 * spacing, y, -0.5), 0.65 * spacing, false);
    }
  }

  private label(text: string, position: THREE.Vector3, height: number, flat: boolean): void {
    const canvas = document.createElement('canvas');
    canvas.width = 256;
    canvas.height = 64;
    const ink = canvas.getContext('2d', {willReadFrequently: true})!;
    ink.font = '600 44px system-ui, sans-serif';
    ink.textAlign = 'center';
    ink.textBaseline = 'middle';
    ink.fillStyle = this.dark ? '#9fb2c8' : '#56616b';
    ink.fillText(text, 128, 34);
    const map = new THREE.CanvasTexture(canvas);
    map.colorSpace = THREE.SRGBColorSpace;
    map.anisotropy = 8;
    const label = new THREE.Mesh(new THREE.PlaneGeometry(4 * height, height), new THREE.MeshBasicMaterial({map, transparent: true, depthWrite: false, polygonOffset: flat, polygonOffsetFactor: -1, polygonOffsetUnits: -4}));
    if (flat) label.rotation.x = -Math.PI / 2;
    label.position.copy(position);
    label.renderOrder = 1;
    this.marks.add(label);
  }
}
