// The ways of bodies, the newest few hundred places of each: of the chosen one, or of everything that moves.
import * as THREE from 'three';

const KEPT = 600, MOST = 200;  // places of a way, ways
const TONES = ['#d6006c', '#1769c2', '#00806b', '#9a5b00', '#7a3fc1'];

class Way {
  private places = new Float32Array(3 * KEPT);
  private count = 0;
  readonly line: THREE.Line;

  constructor(tone: string) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(this.places, 3).setUsage(THREE.DynamicDrawUsage));
    this.line = new THREE.Line(geometry, new THREE.LineBasicMaterial({color: tone}));
    this.line.frustumCulled = false;
  }
  add(place: THREE.Vector3): void {
    if (this.count === KEPT) {
      // The older half gives way at once: moving all of them every frame would cost more than it shows.
      this.places.copyWithin(0, 3 * KEPT / 2);
      this.count = KEPT / 2;
    }
    place.toArray(this.places, 3 * this.count++);
    this.line.geometry.setDrawRange(0, this.count);
    this.line.geometry.getAttribute('position').needsUpdate = true;
  }
  dispose(): void {
    this.line.geometry.dispose();
    (this.line.material as THREE.Material).dispose();
  }
}

export class Trails {
  readonly group = new THREE.Group();
  private ways = new Map<number, Way>();

  constructor() { this.group.visible = false; }

  add(body: number, chosen: number, place: THREE.Vector3): void {
    if (chosen >= 0 && body !== chosen) return;
    let way = this.ways.get(body);
    if (!way) {
      if (this.ways.size >= MOST) return;
      this.ways.set(body, way = new Way(TONES[this.ways.size % TONES.length]));
      this.group.add(way.line);
    }
    way.add(place);
  }

  clear(): void {
    for (const way of this.ways.values()) { this.group.remove(way.line); way.dispose(); }
    this.ways.clear();
  }
}
