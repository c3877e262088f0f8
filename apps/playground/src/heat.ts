// Bodies in the colours of their speeds, with the scale beside them.
import * as THREE from 'three';
import {byId} from './dom';
import {short} from './quantities';

/** Dark blue, teal, yellow, red: told apart without red and green, too. */
const STOPS = ['#243b8f', '#1f8fa6', '#8fc76b', '#f4c430', '#d7301f'];
const TONES = Array.from({length: 64}, (_, i) => {
  const at = i / 63 * (STOPS.length - 1), k = Math.min(STOPS.length - 2, Math.floor(at));
  return new THREE.Color(STOPS[k]).lerp(new THREE.Color(STOPS[k + 1]), at - k);
});

export class Heat {
  on = false;
  private last = -1;
  private top = 1;    // m/s, the end of the scale
  private seen = 0;

  show(on: boolean): void {
    this.on = on;
    this.restart();
    byId('legend').hidden = !on;
    this.say();
  }
  restart(): void { this.last = -1; this.seen = 0; }

  /** Seconds since the frame before; 0 where there is none to compare with. */
  since(time: number): number {
    const since = this.last >= 0 && time > this.last ? time - this.last : 0;
    this.last = time;
    return since;
  }
  /** The scale follows the fastest body, up at once and down slowly, in round numbers. */
  scale(fastest: number): void {
    this.seen = Math.max(fastest, 0.99 * this.seen);
    const power = 10 ** Math.floor(Math.log10(Math.max(this.seen, 1e-3))), lead = this.seen / power;
    const top = (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10) * power;
    if (top === this.top) return;
    this.top = top;
    this.say();
  }
  color(speed: number): THREE.Color { return TONES[Math.min(63, Math.floor(64 * speed / this.top))]; }

  private say(): void { byId('legend-top').textContent = `${short(this.top, 3)} m/s`; }
}
