// The ground (3D) or the paper behind the plane (2D): a metric grid with labelled scale marks.
import * as THREE from 'three';

/** 1, 2 or 5 times a power of ten, near `length`. */
function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const digit = length / power;
  return (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10) * power;
}

export class Ground {
  readonly group = new THREE.Group();
  private dark = false;
  private spacing = 1;
  private level: number | undefined = 0;
  private plane?: {height: number; aspect: number; target: number[]};

  setTheme(dark: boolean): void { this.dark = dark; this.rebuild(); }
  setScale(distance: number): void { this.spacing = roundLength(distance / 12); this.plane = undefined; this.rebuild(); }
  showGround(level: number | undefined): void { this.level = level; this.plane = undefined; this.rebuild(); }
  showPlane(height: number, aspect: number, target: number[]): void { this.plane = {height, aspect, target}; this.rebuild(); }

  private rebuild(): void {
    for (const child of [...this.group.children]) {
      this.group.remove(child);
      const drawn = child as THREE.Mesh;
      drawn.geometry?.dispose();
      (drawn.material as THREE.Material & {map?: THREE.Texture})?.map?.dispose();
      (drawn.material as THREE.Material)?.dispose();
    }
    if (this.plane) this.paper(this.plane.height, this.plane.aspect, this.plane.target);
    else if (this.level !== undefined) this.floor(this.level);
  }

  private floor(level: number): void {
    const tile = 10 * this.spacing, size = 400 * this.spacing;
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = 1024;
    const ink = canvas.getContext('2d')!;
    ink.fillStyle = this.dark ? '#26303c' : '#c9cdc9';
    ink.fillRect(0, 0, 1024, 1024);
    for (let i = 0; i <= 10; ++i) {
      const strong = i % 10 === 0 || i % 5 === 0;
      ink.fillStyle = this.dark ? (strong ? '#55657a' : '#384656') : (strong ? '#8d968f' : '#b3b9b4');
      const w = strong ? 5 : 2.5, at = i * 102.4 - w / 2;
      ink.fillRect(at, 0, w, 1024);
      ink.fillRect(0, at, 1024, w);
    }
    const texture = new THREE.CanvasTexture(canvas);
    texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
    texture.repeat.set(size / tile, size / tile);
    texture.anisotropy = 16;
    texture.colorSpace = THREE.SRGBColorSpace;
    const floor = new THREE.Mesh(new THREE.PlaneGeometry(size, size), new THREE.MeshStandardMaterial({map: texture, roughness: 0.95}));
    floor.rotation.x = -Math.PI / 2;
    floor.position.y = level - 0.002 * this.spacing;
    floor.receiveShadow = true;
    this.group.add(floor);
    for (let i = -4; i <= 4; ++i) {
      if (i === 0) continue;
      const at = i * 5 * this.spacing;
      this.label(`${at} m`, new THREE.Vector3(at, level + 0.004, 0.55 * this.spacing), 0.55 * this.spacing, true);
      this.label(`${at} m`, new THREE.Vector3(0.9 * this.spacing, level + 0.004, at), 0.55 * this.spacing, true);
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
      this.group.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color})));
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
    const ink = canvas.getContext('2d')!;
    ink.font = '600 44px system-ui, sans-serif';
    ink.textAlign = 'center';
    ink.textBaseline = 'middle';
    ink.fillStyle = this.dark ? '#9fb2c8' : '#56616b';
    ink.fillText(text, 128, 34);
    const map = new THREE.CanvasTexture(canvas);
    map.colorSpace = THREE.SRGBColorSpace;
    map.anisotropy = 8;
    const label = new THREE.Mesh(new THREE.PlaneGeometry(4 * height, height), new THREE.MeshBasicMaterial({map, transparent: true, depthWrite: false}));
    if (flat) label.rotation.x = -Math.PI / 2;
    label.position.copy(position);
    label.renderOrder = 1;
    this.group.add(label);
  }
}
