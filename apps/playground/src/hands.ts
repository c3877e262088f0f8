// Pointers on the view: every finger (or the mouse) may hold its own body.
import * as THREE from 'three';
import type {Tools} from './tools';
import type {Viewer} from './viewer';

interface Hold { plane: THREE.Plane; held: boolean; point: THREE.Vector3; target: THREE.Vector3; x: number; y: number }

export class Hands {
  private holds = new Map<number, Hold>();
  private press?: {x: number; y: number};  // of another tool: a click if the pointer stays

  constructor(private canvas: HTMLCanvasElement, private viewer: Viewer, private tools: Tools, private send: (message: object) => void) {
    canvas.style.touchAction = 'none';
    // Capture phase: decide before the orbit controls see the pointer.
    canvas.addEventListener('pointerdown', (event) => this.down(event), true);
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) canvas.addEventListener(end, (event) => this.up(event.pointerId, event));
  }

  private down(event: PointerEvent): void {
    if (event.button !== 0) return;
    if (this.tools.tool !== 'pull') { this.press = {x: event.clientX, y: event.clientY}; return; }
    if (!this.viewer.dynamicBodyAt(event.clientX, event.clientY)) return;
    this.viewer.enableOrbit(false);
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.classList.add('grabbing');
    const ray = this.viewer.ray(event.clientX, event.clientY);
    const hold = {plane: new THREE.Plane(), held: false, point: new THREE.Vector3(), target: new THREE.Vector3(), x: event.clientX, y: event.clientY};
    this.holds.set(event.pointerId, hold);
    this.send({type: 'grab', pointer: event.pointerId, origin: ray.origin.toArray(), direction: ray.direction.toArray()});
  }

  grabbed(pointer: number, body: number, point: number[]): void {
    const hold = this.holds.get(pointer);
    if (!hold) { this.send({type: 'release', pointer}); return; }
    if (body < 0) { this.up(pointer); return; }
    hold.held = true;
    hold.point.set(point[0], point[1], point[2]);
    hold.target.copy(hold.point);
    hold.plane.setFromNormalAndCoplanarPoint(this.viewer.viewDirection, hold.point);
    this.drag(pointer, hold);  // the pointer may have moved before the host answered
  }

  private drag(pointer: number, hold: Hold): void {
    const hit = this.viewer.ray(hold.x, hold.y).intersectPlane(hold.plane, hold.target);
    if (hit) this.send({type: 'drag', pointer, target: hold.target.toArray()});
  }

  private move(event: PointerEvent): void {
    this.tools.hover(event.clientX, event.clientY);
    const hold = this.holds.get(event.pointerId);
    if (!hold) {
      if (event.pointerType === 'mouse' && event.buttons === 0)
        this.canvas.classList.toggle('grab', this.tools.tool === 'pull' && this.viewer.dynamicBodyAt(event.clientX, event.clientY));
      return;
    }
    hold.x = event.clientX;
    hold.y = event.clientY;
    if (hold.held) this.drag(event.pointerId, hold);
  }

  private up(pointer: number, event?: PointerEvent): void {
    if (this.press && event?.type === 'pointerup' && Math.hypot(event.clientX - this.press.x, event.clientY - this.press.y) < 5) this.tools.click(event.clientX, event.clientY);
    if (event) this.press = undefined;
    const hold = this.holds.get(pointer);
    if (!hold) return;
    this.holds.delete(pointer);
    if (hold.held) this.send({type: 'release', pointer});
    if (this.holds.size === 0) {
      this.viewer.enableOrbit(true);
      this.canvas.classList.remove('grabbing');
    }
  }

  releaseAll(): void { for (const pointer of [...this.holds.keys()]) this.up(pointer); }
}
