// The way of one body, the newest few hundred places of it.
import * as THREE from 'three';

const MOST = 1200;

export class Trail {
  private places = new Float32Array(3 * MOST);
  private count = 0;
  readonly line: THREE.Line;

  constructor() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(this.places, 3).setUsage(THREE.DynamicDrawUsage));
    this.line = new THREE.Line(geometry, new THREE.LineBasicMaterial({color: '#d6006c'}));
    this.line.frustumCulled = this.line.visible = false;
    this.clear();
  }

  add(place: THREE.Vector3): void {
    if (this.count === MOST) {
      // The older half gives way at once: moving all of them every frame would cost more than it shows.
      this.places.copyWithin(0, 3 * MOST / 2);
      this.count = MOST / 2;
    }
    place.toArray(this.places, 3 * this.count++);
    this.line.geometry.setDrawRange(0, this.count);
    this.line.geometry.getAttribute('position').needsUpdate = true;
  }

  clear(): void {
    this.count = 0;
    this.line.geometry.setDrawRange(0, 0);
  }
}
