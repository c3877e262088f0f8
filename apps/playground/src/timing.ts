// How long the engine's stages took lately, stacked, with the budget of a frame at 60 a second.
import {byId, element} from './dom';

const COLORS = ['#4a8fe7', '#2a9d8f', '#d99a1c', '#e07a9b', '#e4572e', '#9b6dd6', '#6bbf59', '#00a6c7', '#b5651d', '#8a8f98'];
const KEPT = 120, FRAME = 1000 / 60;

export class Timing {
  private past: number[][] = [];
  private names: string[] = [];

  constructor(private canvas: HTMLCanvasElement) {}

  add(stages: Record<string, number>): void {
    const names = Object.keys(stages).filter((name) => name !== 'whole step');
    if (names.join() !== this.names.join()) { this.names = names; this.past = []; this.legend(); }
    this.past.push(names.map((name) => stages[name]));
    if (this.past.length > KEPT) this.past.shift();
    this.draw();
  }

  private legend(): void {
    byId('timing-legend').replaceChildren(...this.names.map((name, i) => {
      const item = element('li', {textContent: name});
      item.style.setProperty('--color', COLORS[i % COLORS.length]);
      return item;
    }));
  }

  private draw(): void {
    const ink = this.canvas.getContext('2d');
    if (!ink || this.canvas.clientWidth === 0) return;
    const {width, height} = this.canvas, style = getComputedStyle(this.canvas);
    const most = Math.max(0.1, ...this.past.map((one) => one.reduce((sum, x) => sum + x, 0)));
    const top = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((x) => x >= most) ?? most;
    const y = (ms: number) => height - 4 - (height - 28) * ms / top;
    ink.clearRect(0, 0, width, height);
    const bar = width / KEPT;
    this.past.forEach((one, i) => {
      let sum = 0;
      one.forEach((ms, k) => {
        ink.fillStyle = COLORS[k % COLORS.length];
        ink.fillRect((KEPT - this.past.length + i) * bar, y(sum + ms), bar + 0.5, y(sum) - y(sum + ms));
        sum += ms;
      });
    });
    ink.fillStyle = ink.strokeStyle = style.color;
    ink.font = '22px system-ui, sans-serif';
    for (const ms of [top, top / 2]) {
      ink.globalAlpha = 0.25;
      ink.fillRect(0, y(ms), width, 1);
      ink.globalAlpha = 1;
      ink.fillText(`${ms} ms`, 6, y(ms) - 5);
    }
    if (FRAME < top) { ink.fillRect(0, y(FRAME), width, 2); ink.fillText('one frame', width - 110, y(FRAME) - 5); }
  }
}
