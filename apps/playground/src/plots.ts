// Live plots of what the demo declared, with the fixed (analytic or published) curves beside them.
import uPlot from 'uplot';
import type {PlotDeclaration} from './protocol';
import {short} from './quantities';

const COLORS = ['#e4572e', '#4a8fe7', '#2a9d8f', '#d99a1c', '#9b6dd6', '#e07a9b'];
const LIMIT = 6000;  // samples kept of a series; beyond it every second one is dropped

type Curve = {x: number[]; y: number[]};

export class Plots {
  private declarations: PlotDeclaration[] = [];
  private curves: Curve[][] = [];
  private chosen = 0;
  private chart?: uPlot;
  private dirty = false;

  constructor(private host: HTMLElement, private choice: HTMLElement) {
    new ResizeObserver(() => this.rebuild()).observe(host);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.rebuild());
  }

  open(declarations: PlotDeclaration[]): void {
    this.declarations = declarations;
    this.chosen = 0;
    this.choice.replaceChildren();
    if (declarations.length > 1) {
      const select = document.createElement('select');
      select.setAttribute('aria-label', 'Which plot');
      select.append(...declarations.map((d, i) => new Option(d.title, String(i))));
      select.onchange = () => { this.chosen = Number(select.value); this.rebuild(); };
      this.choice.append(select);
    }
    this.restart();
  }

  restart(): void {
    this.curves = this.declarations.map((d) => d.series.map((s) => ({x: (s.points ?? []).map((p) => p[0]), y: (s.points ?? []).map((p) => p[1])})));
    this.rebuild();
  }

  add(plot: number, series: number, x: number, y: number): void {
    const curve = this.curves[plot]?.[series];
    if (!curve || this.declarations[plot].series[series].points) return;
    if (curve.x.length > 0 && x < curve.x[curve.x.length - 1] - 1e-9 && this.declarations[plot].x.unit === 's') curve.x.length = curve.y.length = 0;
    curve.x.push(x);
    curve.y.push(y);
    if (curve.x.length > LIMIT) {
      curve.x = curve.x.filter((_, i) => i % 2 === 0);
      curve.y = curve.y.filter((_, i) => i % 2 === 0);
    }
    if (plot === this.chosen) this.dirty = true;
  }

  draw(): void {
    if (!this.dirty || !this.chart) return;
    this.dirty = false;
    this.chart.setData(this.data());
  }

  /** Mode 2 of uPlot: every series has its own x values. */
  private data(): uPlot.AlignedData {
    const curves = this.curves[this.chosen] ?? [];
    return [null, ...curves.map((c) => [c.x, c.y])] as unknown as uPlot.AlignedData;
  }

  private rebuild(): void {
    this.chart?.destroy();
    this.chart = undefined;
    const d = this.declarations[this.chosen];
    this.host.hidden = !d;
    if (!d || this.host.clientWidth < 50) return;
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue('--ink-soft'), grid = style.getPropertyValue('--line');
    const axis = (a: {label: string; unit: string}, size: number): uPlot.Axis => ({
      label: a.unit ? `${a.label} (${a.unit})` : a.label, stroke: ink, grid: {stroke: grid, width: 1}, ticks: {stroke: grid, width: 1},
      size, labelSize: 20, font: '12px system-ui', labelFont: '12px system-ui', values: (_, ticks) => ticks.map((t) => short(t, 5)),
    });
    const range = (k: 'x' | 'y') => (): [number, number] => {
      let low = Infinity, high = -Infinity;
      for (const c of this.curves[this.chosen] ?? []) for (const v of c[k]) if (Number.isFinite(v)) { if (v < low) low = v; if (v > high) high = v; }
      if (low > high) return [0, 1];
      const pad = k === 'y' ? 0.06 * (high - low) || Math.max(1e-6, 0.1 * Math.abs(high)) || 1 : 0;
      return [low - pad, high > low || pad ? high + pad : low + 1];
    };
    // A series' path in its own x values; points beyond the pixel grid cost nothing.
    const paths = (marks: boolean): uPlot.Series.PathBuilder => (u, index) => {
      const {x, y} = this.curves[this.chosen][index - 1] ?? {x: [], y: []};
      const path = new Path2D();
      let lastX = NaN, lastY = NaN;
      for (let i = 0; i < x.length; ++i) {
        const px = u.valToPos(x[i], 'x', true), py = u.valToPos(y[i], 'y', true);
        if (marks) { path.moveTo(px + 3.5, py); path.arc(px, py, 3.5, 0, 2 * Math.PI); continue; }
        if (Math.abs(px - lastX) < 0.5 && Math.abs(py - lastY) < 0.5) continue;
        if (i === 0) path.moveTo(px, py); else path.lineTo(px, py);
        lastX = px; lastY = py;
      }
      return {stroke: path, fill: marks ? path : undefined, clip: null as unknown as Path2D, flags: 1 | 2} as uPlot.Series.Paths;
    };
    this.chart = new uPlot({
      mode: 2, width: this.host.clientWidth, height: 230,
      scales: {x: {time: false, range: range('x')}, y: {range: range('y')}},
      legend: {show: true, live: false}, cursor: {drag: {x: true, y: true}},
      axes: [axis(d.x, 46), axis(d.y, 62)],
      series: [{}, ...d.series.map((s, i): uPlot.Series => ({
        label: s.name, facets: [{scale: 'x', auto: true}, {scale: 'y', auto: true}], stroke: s.color ?? COLORS[i % COLORS.length],
        fill: s.style === 'points' ? s.color ?? COLORS[i % COLORS.length] : undefined, width: 1.75, paths: paths(s.style === 'points'),
      }))],
    }, this.data(), this.host);
  }
}
