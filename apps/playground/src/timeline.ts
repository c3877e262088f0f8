// The last minute of the run as a slider: dragging it shows the past, and the run goes on from there.
import {byId} from './dom';

export class Timeline {
  private slider = byId<HTMLInputElement>('past');
  private first = 0;
  private last = 0;
  private step = 0;
  private dt = 1 / 60;
  private waiting = false;
  private wanted?: number;
  private fixed = false;  // played, not simulated: the whole length is known

  constructor(private send: (message: object) => void) {
    this.slider.oninput = () => this.seek(Number(this.slider.value));
    byId('back').onclick = () => this.seek(this.step - 1);
  }

  open(dt: number): void {
    this.dt = dt;
    this.first = this.last = this.step = 0;
    this.fixed = false;
    this.failed();  // what was wished for was of another run
    this.show();
  }

  status(step: number, first: number, last: number, fixed: boolean): void {
    this.fixed = fixed;
    this.step = step;
    this.first = first;
    this.last = last;
    this.waiting = false;
    this.show();
    if (this.wanted !== undefined) { const next = this.wanted; this.wanted = undefined; this.seek(next); }
  }

  frame(step: number): void {
    this.step = step;
    if (this.fixed) { this.show(); return; }
    this.last = Math.max(step, this.last);
    this.first = Math.max(this.first, this.last - Math.round(60 / this.dt));
    if (!this.waiting) this.show();
  }

  /** One request at a time: where going back takes long, only the newest wish counts. */
  seek(step: number): void {
    if (this.waiting) { this.wanted = step; return; }
    this.waiting = true;
    this.send({type: 'seek', step: Math.max(this.first, Math.min(this.last, step))});
  }
  /** The host refused: nothing is under way any more. */
  failed(): void { this.waiting = false; this.wanted = undefined; }

  private show(): void {
    this.slider.min = String(this.first);
    this.slider.max = String(this.last);
    if (this.wanted === undefined) this.slider.value = String(this.step);
    this.slider.setAttribute('aria-valuetext', `${(this.step * this.dt).toFixed(2)} of ${(this.last * this.dt).toFixed(2)} seconds`);
    byId<HTMLButtonElement>('back').disabled = this.step <= this.first;
  }
}
