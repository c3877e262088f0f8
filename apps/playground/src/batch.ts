// Bodies that share a geometry, drawn by one call.
import * as THREE from 'three';

const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);

/** One instanced mesh for all shapes of one geometry. Grows by doubling. */
export class Batch {
  mesh: THREE.InstancedMesh;
  owners: number[] = [];
  private free: number[] = [];

  private geometry?: THREE.BufferGeometry;
  private fine = 0;

  constructor(private build: (fine: number) => THREE.BufferGeometry, private material: THREE.Material, private parent: THREE.Object3D) {
    this.mesh = this.allocate(16);
  }
  private allocate(capacity: number): THREE.InstancedMesh {
    // Thousands of round bodies are small on the screen: coarser ones do.
    const fine = capacity > 4096 ? 0.3 : capacity > 512 ? 0.5 : 1;
    if (fine !== this.fine) {
      this.geometry?.dispose();
      this.geometry = this.build(fine);
      this.fine = fine;
    }
    const mesh = new THREE.InstancedMesh(this.geometry, this.material, capacity);
    mesh.count = 0;
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
    mesh.setColorAt(0, new THREE.Color());
    this.parent.add(mesh);
    return mesh;
  }
  add(owner: number, matrix: THREE.Matrix4, color: THREE.Color): number {
    const free = this.free.pop();
    if (free !== undefined) {
      this.owners[free] = owner;
      this.mesh.setMatrixAt(free, matrix);
      this.mesh.setColorAt(free, color);
      this.touch();
      return free;
    }
    const slot = this.mesh.count;
    if (slot === this.mesh.instanceMatrix.count) {
      const old = this.mesh;
      this.mesh = this.allocate(2 * slot);
      this.mesh.instanceMatrix.array.set(old.instanceMatrix.array);
      this.mesh.instanceColor!.array.set(old.instanceColor!.array);
      this.mesh.count = slot;
      this.parent.remove(old);
      old.dispose();
    }
    this.owners[slot] = owner;
    this.mesh.count = slot + 1;
    this.mesh.setMatrixAt(slot, matrix);
    this.mesh.setColorAt(slot, color);
    this.touch();
    return slot;
  }
  /** Its place shows nothing until another one takes it. */
  remove(slot: number): void {
    this.mesh.setMatrixAt(slot, NOWHERE);
    this.owners[slot] = -1;
    this.free.push(slot);
    this.touch();
  }
  touch(): void {
    this.mesh.instanceMatrix.needsUpdate = true;
    this.mesh.instanceColor!.needsUpdate = true;
    this.mesh.boundingSphere = null;
  }
  dispose(): void {
    this.parent.remove(this.mesh);
    this.mesh.dispose();
    this.geometry?.dispose();
  }
}
