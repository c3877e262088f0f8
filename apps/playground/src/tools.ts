// What a pointer does on the view besides pulling, and what is drawn over the scene.
import {byId, element} from './dom';
import type {Layer, LegendEntry, Probed} from './protocol';
import {short} from './quantities';
import type {Viewer} from './viewer';

export type Tool = 'pull' | 'throw' | 'ray' | 'sphere' | 'closest' | 'why';
const TOOLS: [Tool, string, string][] = [
  ['pull', 'Pull', 'Drag a body to pull and throw it'], ['throw', 'Shoot', 'Click to shoot a body into the scene'],
  ['ray', 'Ray', 'Point to cast a ray'], ['sphere', 'Sphere', 'Point to cast a sphere'], ['closest', 'Closest', 'Point to find the closest other body'],
  ['why', 'Why', 'Click a body to read why it does what it does'],
];
export class Tools {
  tool: Tool = 'pull';
  private layers = new Set<string>();
  private offered = element('div');
  private legend = element('ul', {className: 'legend'});
  private asked = 0;

  constructor(private viewer: Viewer, private send: (message: object) => void) {
    byId('tools').replaceChildren(...TOOLS.map(([tool, label, title]) => {
      const button = element('button', {type: 'button', textContent: label, title});
      button.setAttribute('aria-pressed', String(tool === this.tool));
      button.onclick = () => this.choose(tool);
      return button;
    }));
    byId('layers').replaceChildren(this.offered, this.legend, this.toggle('Shapes', '', true, (on) => { this.viewer.showShapes(on); }),
    this.toggle('Shadows', '', true, (on) => { this.viewer.showShadows(on); }),
    this.toggle('Trails', 'of the chosen body, or of all that move', false, (on) => { this.viewer.showTrails(on); }),
    this.toggle('Heat colours', 'bodies coloured by their speed', false, (on) => { this.viewer.showHeat(on); }));
  }

  /** Toggles for the layers of debug drawing that the host has. */
  offer(layers: Layer[]): void {
    this.offered.replaceChildren(...layers.map(({name, label, legend}) => this.toggle(label, legend, this.layers.has(name), (on) => {
      if (on) this.layers.add(name); else this.layers.delete(name);
      this.draw();
    }, name)));
  }

  private toggle(label: string, legend: string, on: boolean, change: (on: boolean) => void, layer?: string): HTMLElement {
    const box = element('input', {type: 'checkbox', checked: on});
    box.onchange = () => change(box.checked);
    if (layer) box.dataset.layer = layer;
    return element('label', {className: 'toggle', title: legend}, box, label, ...(legend ? [element('small', {textContent: ` ${legend}`})] : []));
  }

  choose(tool: Tool): void {
    this.tool = tool;
    TOOLS.forEach(([name], i) => byId('tools').children[i].setAttribute('aria-pressed', String(name === tool)));
    byId('throw-options').hidden = tool !== 'throw';
    this.viewer.showMark();
    byId('probe').textContent = '';
  }

  /** What colours stand for in this scene. */
  explain(legend: LegendEntry[]): void {
    this.legend.replaceChildren(...legend.map(({label, color}) => {
      const swatch = element('span', {className: 'swatch'});
      swatch.style.background = color;
      return element('li', {}, swatch, label);
    }));
  }

  /** After an open or a reconnect the host knows of no layers. */
  draw(): void { this.send({type: 'draw', layers: [...this.layers]}); }

  /** A click of the chosen tool; false where it has none. */
  click(x: number, y: number): boolean {
    if (this.tool === 'why') {
      const id = this.viewer.bodyAt(x, y);
      this.viewer.choose(id);
      this.send({type: 'inspect', body: id});
      return true;
    }
    if (this.tool === 'throw') { this.shoot(x, y); return true; }
    return this.tool !== 'pull';
  }

  private number(id: string): number { return Number(byId<HTMLInputElement>(id).value); }

  shoot(x: number, y: number): void {
    const ray = this.viewer.ray(x, y), flat = this.viewer.dimension === 2;
    const size = this.number('throw-size'), speed = this.number('throw-speed');
    const from = flat ? ray.origin.clone().setZ(0) : ray.origin.clone().addScaledVector(ray.direction, 1 + 2 * size);
    // In the plane a shot falls in from above; in space it flies where one looks.
    const velocity = flat ? [0, -speed, 0] : ray.direction.clone().multiplyScalar(speed).toArray();
    this.send({type: 'spawn', form: byId<HTMLSelectElement>('throw-form').value, size, density: this.number('throw-density'), position: from.toArray(), velocity});
  }

  /** The pointer moved: a probe follows it, twenty times a second. */
  hover(x: number, y: number): void {
    if (this.tool !== 'ray' && this.tool !== 'sphere' && this.tool !== 'closest') return;
    const now = performance.now();
    if (now - this.asked < 50) return;
    this.asked = now;
    const ray = this.viewer.ray(x, y);
    this.send({type: 'probe', kind: this.tool, origin: ray.origin.toArray(), direction: ray.direction.toArray(), radius: this.tool === 'closest' ? 20 : 0.25});
  }

  probed(answer: Probed): void {
    if (answer.body < 0) {
      this.viewer.showMark();
      byId('probe').textContent = 'nothing there';
      return;
    }
    this.viewer.showMark(answer.point, answer.normal);
    byId('probe').textContent = `${this.viewer.nameOf(answer.body)}: ${short(answer.distance, 5)} m ${answer.kind === 'closest' ? 'away' : 'along the ray'}, at ${answer.point.map((x) => short(x, 4)).join(', ')} m, normal ${answer.normal.map((x) => short(x, 3)).join(', ')}`;
  }
}
