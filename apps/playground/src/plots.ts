// Live plots of what the demo declared, with the fixed (analytic or published) curves beside them.
import './locale';  // before uPlot, which formats numbers as it loads
import uPlot from 'uplot';
import type {PlotDeclaration} from './protocol';
import {byId, download} from './dom';
import {short, tickLabels} from './quantities';

const COLORS = ['#e4572e', '#4a8fe7', '#2a9d8f', '#d99a1c', '#9b6dd6', '#e07a9b'];
const LIMIT = 6000;  // samples kept of a series; beyond it every second one is dropped

type Curve = {x: number[]; y: number[]};

export class Plots {
  private declarations: PlotDeclaration[] = [];
  private curves: Curve[][] = [];
  private chosen = 0;
  private chart?: uPlot;
  private dirty = false;
  private zoom?: {x: [number, number]; y: [number, number]};

  constructor(private host: HTMLElement, private choice: HTMLElement) {
    new ResizeObserver(() => this.rebuild()).observe(host);
    byId('plot-csv').onclick = () => this.saveCsv();
    byId('plot-png').onclick = () => this.savePng();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.rebuild());
  }

  open(declarations: PlotDeclaration[]): void {
    this.declarations = declarations;
    this.chosen = 0;
    this.zoom = undefined;
    this.choice.replaceChildren();
    if (declarations.length > 1) {
      const select = document.createElement('select');
      select.setAttribute('aria-label', 'Which plot');
      select.append(...declarations.map((d, i) => new Option(d.title, String(i))));
      select.onchange = () => { this.chosen = Number(select.value); this.zoom = undefined; this.rebuild(); };
      this.choice.append(select);
    }
    this.restart();
  }

  redraw(): void { this.rebuild(); }

  /** What the curves show where the cursor is. */
  private readOut(u: uPlot): void {
    const d = this.declarations[this.chosen], left = u.cursor.left ?? -1;
    if (!d || left < 0) { byId('plot-value').textContent = ''; return; }
    const x = u.posToVal(left, 'x');
    const parts = d.series.map((s, i) => {
      const curve = this.curves[this.chosen][i];
      let best = -1;
      for (let k = 0; k < curve.x.length; ++k) if (best < 0 || Math.abs(curve.x[k] - x) < Math.abs(curve.x[best] - x)) best = k;
      return best < 0 ? '' : `${s.name} ${short(curve.y[best], 5)}`;
    }).filter((t) => t);
    byId('plot-value').textContent = `${d.x.label} ${short(x, 4)} ${d.x.unit}: ${parts.join(', ')} ${d.y.unit}`;
  }

  private name(suffix: string): string { return `${this.declarations[this.chosen].title.replace(/[^\w]+/g, '-').toLowerCase()}.${suffix}`; }

  /** One row a sample: the series have x values of their own. */
  private saveCsv(): void {
    const d = this.declarations[this.chosen];
    if (!d) return;
    const quoted = (text: string) => `"${text.replace(/"/g, '""')}"`;
    const head = ['series', `${d.x.label} (${d.x.unit})`, `${d.y.label} (${d.y.unit})`].map(quoted).join(',');
    const rows = d.series.flatMap((s, i) => this.curves[this.chosen][i].x.map((x, k) => `${quoted(s.name)},${x},${this.curves[this.chosen][i].y[k]}`));
    download(this.name('csv'), new Blob([[head, ...rows].join('\r\n'), '\r\n'], {type: 'text/csv'}));
  }

  private savePng(): void {
    const chart = this.host.querySelector('canvas');
    if (!chart) return;
    const picture = document.createElement('canvas');
    picture.width = chart.width;
    picture.height = chart.height;
    const ink = picture.getContext('2d')!;
    ink.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--panel');
    ink.fillRect(0, 0, picture.width, picture.height);
    ink.drawImage(chart, 0, 0);
    picture.toBlob((data) => { if (data) download(this.name('png'), data); });
  }

  /** The run went back to this time: what came after is not so any more. */
  cut(time: number): void {
    this.declarations.forEach((d, plot) => {
      if (d.x.unit !== 's') return;
      d.series.forEach((s, series) => {
        const curve = this.curves[plot][series];
        if (s.points || curve.x.length === 0 || curve.x[curve.x.length - 1] <= time + 1e-9) return;
        const keep = curve.x.findIndex((x) => x > time + 1e-9);
        curve.x.length = curve.y.length = keep;
        this.dirty = true;
      });
    });
  }

  restart(): void {
    this.curves = this.declarations.map((d) => d.series.map((s) => ({x: (s.points ?? []).map((p) => p[0]), y: (s.points ?? []).map((p) => p[1])})));
    this.rebuild();
  }

  add(plot: number, series: number, x: number, y: number): void {
    const curve = this.curves[plot]?.[series];
    if (!curve || this.declarations[plot].series[series].points) return;
    if (plot === this.chosen) this.dirty = true;
    const old = this.declarations[plot].series[series].latest ? curve.x.indexOf(x) : -1;
    if (old >= 0) {
      curve.y[old] = y;
      return;
    }
    if (curve.x.length > 0 && x < curve.x[curve.x.length - 1] - 1e-9 && this.declarations[plot].x.unit === 's') curve.x.length = curve.y.length = 0;
    curve.x.push(x);
    curve.y.push(y);
    if (curve.x.length > LIMIT) {
      curve.x = curve.x.filter((_, i) => i % 2 === 0);
      curve.y = curve.y.filter((_, i) => i % 2 === 0);
    }
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
    const scale = parseFloat(style.fontSize) / 16, font = `${12 * scale}px system-ui`;  // as large as the page's text
    const axis = (a: {label: string; unit: string}, wide: boolean): uPlot.Axis => ({
      label: a.unit ? `${a.label} (${a.unit})` : a.label, stroke: ink, grid: {stroke: grid, width: 1}, ticks: {stroke: grid, width: 1},
      size: wide ? (_, labels) => scale * (20 + 7 * Math.max(3, ...(labels ?? []).map((l) => l.length))) : 46 * scale, labelSize: 20 * scale, font, labelFont: font, values: (_, ticks, _axis, _space, increment) => tickLabels(ticks, increment),
    });
    const range = (k: 'x' | 'y') => (): [number, number] => {
      if (this.zoom) return this.zoom[k];
      let low = Infinity, high = -Infinity;
      for (const c of this.curves[this.chosen] ?? []) for (const v of c[k]) if (Number.isFinite(v)) { if (v < low) low = v; if (v > high) high = v; }
      if (low > high) return [0, 1];
      // What varies by less than a millionth of itself is drawn as the constant that it is.
      const size = Math.max(Math.abs(low), Math.abs(high));
      // Along x only marks need room at the ends.
      const pad = k === 'x' ? (d.series.some((s) => s.style === 'points') ? 0.02 * (high - low) : 0) : high - low > 1e-6 * size ? 0.06 * (high - low) : 0.1 * size || 1;
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
      mode: 2, width: this.host.clientWidth, height: 230 * scale,
      scales: {x: {time: false, range: range('x')}, y: {range: range('y')}},
      legend: {show: true, live: false}, cursor: {drag: {x: true, y: true, setScale: false}, bind: {dblclick: () => () => { this.zoom = undefined; this.dirty = true; return null; }}},
      hooks: {
        setCursor: [(u) => this.readOut(u)],
        setSelect: [(u) => {
          const {left, top, width, height} = u.select;
          if (width < 4 && height < 4) return;
          const whole = (low: number, high: number, k: 'x' | 'y'): [number, number] => high > low ? [low, high] : [u.scales[k].min!, u.scales[k].max!];
          this.zoom = {x: whole(u.posToVal(left, 'x'), u.posToVal(left + width, 'x'), 'x'), y: whole(u.posToVal(top + height, 'y'), u.posToVal(top, 'y'), 'y')};
          this.dirty = true;
          u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
        }],
      },
      axes: [axis(d.x, false), axis(d.y, true)],
      series: [{}, ...d.series.map((s, i): uPlot.Series => ({
        label: s.name, facets: [{scale: 'x', auto: true}, {scale: 'y', auto: true}], stroke: s.color ?? COLORS[i % COLORS.length],
        fill: s.style === 'points' ? s.color ?? COLORS[i % COLORS.length] : undefined, width: 1.75, paths: paths(s.style === 'points'),
      }))],
    }, this.data(), this.host);
  }
}
