// The bodies of a scene as they are drawn: where they are, in which colours, and which one a ray meets.
import * as THREE from 'three';
import {Batch} from './batch';
import type {Seen} from './framing';
import {Heat} from './heat';
import {BODY_BYTES, type Body, type Frame, type Mesh, type Shape} from './protocol';
import {drawable2, drawable3, reachOf, type Drawable} from './shapes';
import {Trails} from './trail';

const PALETTE = ['#e4572e', '#f4b942', '#2a9d8f', '#4a8fe7', '#9b6dd6', '#e07a9b', '#6bbf59', '#d98e4a'];
const SLEEP_TONE = new THREE.Color('#8a8f98');

interface Part { batch: Batch; slot: number; local: THREE.Matrix4; color: THREE.Color }
interface Drawn { body: Body; parts: Part[]; position: THREE.Vector3; rotation: THREE.Quaternion; color: THREE.Color; asleep: boolean; heat: number }

export class Bodies {
  readonly root = new THREE.Group();
  readonly trails = new Trails();
  chosen = -1;
  pixel = 0.02;  // metres that a pixel of the plane shows, about
  private dimension: 2 | 3 = 3;
  private heat = new Heat();
  private material = new THREE.MeshStandardMaterial({vertexColors: true, roughness: 0.72, metalness: 0});
  private material2 = new THREE.MeshBasicMaterial({vertexColors: true, side: THREE.DoubleSide});
  private batches = new Map<string, Batch>();
  private drawn = new Map<number, Drawn>();
  private meshes = new Map<number, Mesh>();
  private waiting: {id: number; shape: Shape}[] = [];
  private before = new THREE.Vector3();
  private moved = new Set<number>();

  open(dimension: 2 | 3): void {
    this.dimension = dimension;
    this.meshes.clear();
  }

  clear(): void {
    for (const batch of this.batches.values()) batch.dispose();
    this.batches.clear();
    this.drawn.clear();
    this.waiting = [];
    this.trails.clear();
    this.heat.restart();
  }

  get(id: number): Drawn | undefined { return this.drawn.get(id); }
  ids(type: Body['type']): number[] { return [...this.drawn.values()].filter((d) => d.body.type === type).map((d) => d.body.id); }

  /** What a camera must show: places and how far they reach; planes have no end and are left out. */
  *seen(): Iterable<Seen> {
    for (const {body, position} of this.drawn.values()) {
      const reach = Math.max(0, ...body.shapes.map(reachOf));
      if (Number.isFinite(reach)) yield {position, reach};
    }
  }

  add(body: Body, origin: THREE.Vector3): void {
    const [w, x, y, z] = body.rotation;
    const drawn: Drawn = {
      body, parts: [], asleep: false, heat: 0, color: new THREE.Color(body.color ?? this.colorOf(body)),
      position: new THREE.Vector3(...(body.position as [number, number, number])).sub(origin), rotation: new THREE.Quaternion(x, y, z, w),
    };
    this.drawn.set(body.id, drawn);
    for (const shape of body.shapes) this.addShape(drawn, shape);
  }

  private colorOf(body: Body): string {
    if (body.type === 'fixed') return this.dimension === 2 ? '#7d8894' : '#b9b4a9';
    if (body.type === 'kinematic') return '#7a8fa6';
    return PALETTE[body.id % PALETTE.length];
  }

  private addShape(drawn: Drawn, shape: Shape): void {
    const found: Drawable | undefined = this.dimension === 3 ? drawable3(shape, this.meshes) : drawable2(shape, this.pixel);
    if (!found) {
      if (shape.kind === 'mesh') this.waiting.push({id: drawn.body.id, shape});
      return;
    }
    const opacity = shape.sensor ? Math.min(0.35, shape.opacity ?? 1) : shape.opacity ?? 1;
    const key = `${found.key} ${opacity.toFixed(2)}${shape.sensor ? ' sensor' : ''}`;
    let batch = this.batches.get(key);
    if (!batch) this.batches.set(key, batch = new Batch(found.build, this.materialFor(opacity), this.root));
    const [px, py, pz, qw, qx, qy, qz] = shape.local;
    const local = new THREE.Matrix4().compose(new THREE.Vector3(px, py, pz), new THREE.Quaternion(qx, qy, qz, qw), found.scale);
    const pose = new THREE.Matrix4().compose(drawn.position, drawn.rotation, new THREE.Vector3(1, 1, 1));
    const color = shape.color ? new THREE.Color(shape.color) : drawn.color;
    drawn.parts.push({batch, local, color, slot: batch.add(drawn.body.id, pose.multiply(local), color)});
  }

  private materialFor(opacity: number): THREE.Material {
    const solid = this.dimension === 3 ? this.material : this.material2;
    if (opacity > 0.99) return solid;
    const glass = solid.clone();
    glass.transparent = true;
    glass.opacity = opacity;
    glass.depthWrite = false;
    if (this.dimension === 3) glass.side = THREE.DoubleSide;
    return glass;
  }

  remove(ids: number[]): void {
    for (const id of ids) {
      for (const {batch, slot} of this.drawn.get(id)?.parts ?? []) batch.remove(slot);
      this.drawn.delete(id);
    }
    const gone = new Set(ids);
    this.waiting = this.waiting.filter((w) => !gone.has(w.id));
  }

  addMesh(mesh: Mesh): void {
    this.meshes.set(mesh.id, mesh);
    const ready = this.waiting.filter((w) => w.shape.mesh === mesh.id);
    this.waiting = this.waiting.filter((w) => w.shape.mesh !== mesh.id);
    for (const {id, shape} of ready) {
      const drawn = this.drawn.get(id);
      if (drawn) this.addShape(drawn, shape);
    }
  }

  /** `shift`: from the frame's origin to that of the view. */
  apply(frame: Frame, shift: THREE.Vector3): void {
    const pose = new THREE.Matrix4(), matrix = new THREE.Matrix4(), unit = new THREE.Vector3(1, 1, 1);
    const touched = new Set<Batch>(), since = this.heat.on ? this.heat.since(frame.time) : 0;
    const view = frame.bodies;
    for (let i = 0; i < frame.count; ++i) {
      const at = i * BODY_BYTES;
      const word = view.getUint32(at, true);
      const drawn = this.drawn.get(word & 0x7fffffff);
      if (!drawn) continue;
      if (since > 0) this.before.copy(drawn.position);
      drawn.position.set(view.getFloat32(at + 4, true), view.getFloat32(at + 8, true), view.getFloat32(at + 12, true)).add(shift);
      if (since > 0) drawn.heat = this.before.distanceTo(drawn.position) / since;
      drawn.rotation.set(view.getInt16(at + 16, true), view.getInt16(at + 18, true), view.getInt16(at + 20, true), view.getInt16(at + 22, true)).normalize();
      pose.compose(drawn.position, drawn.rotation, unit);
      const asleep = (word >>> 31) === 1;
      for (const {batch, slot, local, color} of drawn.parts) {
        batch.mesh.setMatrixAt(slot, matrix.multiplyMatrices(pose, local));
        if (asleep !== drawn.asleep && !this.heat.on) batch.mesh.setColorAt(slot, this.tone(color, asleep));
        touched.add(batch);
      }
      drawn.asleep = asleep;
      if (this.trails.group.visible && drawn.body.type !== 'fixed') this.trails.add(drawn.body.id, this.chosen, drawn.position);
    }
    if (since > 0) this.paintHeat(frame, touched);
    for (const batch of touched) batch.touch();
  }

  private mixed = new THREE.Color();
  private tone(color: THREE.Color, asleep: boolean): THREE.Color { return asleep ? this.mixed.copy(color).lerp(SLEEP_TONE, 0.35) : color; }

  /** What is not in a frame stands still. */
  private paintHeat(frame: Frame, touched: Set<Batch>): void {
    this.moved.clear();
    for (let i = 0; i < frame.count; ++i) this.moved.add(frame.bodies.getUint32(i * BODY_BYTES, true) & 0x7fffffff);
    let fastest = 0;
    for (const drawn of this.drawn.values()) {
      if (!this.moved.has(drawn.body.id)) drawn.heat = 0;
      fastest = Math.max(fastest, drawn.heat);
    }
    this.heat.scale(fastest);
    for (const drawn of this.drawn.values())
      if (drawn.body.type === 'dynamic') for (const {batch, slot} of drawn.parts) { batch.mesh.setColorAt(slot, this.heat.color(drawn.heat)); touched.add(batch); }
  }
  showHeat(on: boolean): void {
    this.heat.show(on);
    for (const drawn of this.drawn.values())
      for (const {batch, slot, color} of drawn.parts) { batch.mesh.setColorAt(slot, this.tone(color, drawn.asleep)); batch.touch(); }
  }
  showTrails(on: boolean): void {
    this.trails.group.visible = on;
    this.trails.clear();
  }
  choose(id: number): void {
    if (id === this.chosen) return;
    this.chosen = id;
    this.trails.clear();
  }

  /** The body that a ray meets first, sensors apart; −1: none. */
  hit(caster: THREE.Raycaster): number {
    // Sensors push nothing, and nothing holds them.
    const solid = [...this.batches].filter(([key]) => !key.endsWith(' sensor')).map(([, batch]) => batch);
    const hit = caster.intersectObjects(solid.map((batch) => batch.mesh), false)[0];
    if (hit?.instanceId === undefined) return -1;
    return solid.find((batch) => batch.mesh === hit.object)?.owners[hit.instanceId] ?? -1;
  }
}
