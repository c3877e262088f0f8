// The side panel: text, sliders made from the demo's declaration, and numbers.
import type {Numbers, Opened, Parameter, Stats} from './protocol';
import {element} from './dom';
import {fromDisplay, short, toDisplay, unitOf} from './quantities';

interface Lesson { formulas?: string[]; symbols: Record<string, string>; try: string[]; ends: string }

/** A scene file may name its parameters as a program does. */
const labelOf = (p: Parameter) => {
  const plain = p.label.replace(/_/g, ' ');
  return plain.charAt(0).toUpperCase() + plain.slice(1);
};

const LONG = 40000;  // characters of a scene file that the panel shows

export class Panel {
  private shown = new Map<string, (si: number) => void>();

  constructor(private send: (message: object) => void) {}

  open(demo: Opened): void {
    const about = document.getElementById('about')!;
    about.replaceChildren(element('p', {className: 'summary', textContent: demo.summary}));
    about.append(this.lesson(demo));
    about.append(this.source(demo.demo), this.sceneFile());
    const list = document.getElementById('parameters')!;
    this.shown.clear();
    list.replaceChildren(...demo.parameters.map((p) => p.choices ? this.choice(p, p.choices) : this.slider(p)));
    list.parentElement!.hidden = demo.parameters.length === 0;
    document.getElementById('plot-heading')!.parentElement!.hidden = demo.plots.length === 0;
    this.inputs(demo);
  }

  /** The page of a demo: plain words and formulas; then, fetched when somebody reads it, symbols, what to try, where the model ends. */
  private lesson(demo: Opened): HTMLElement {
    const text = element('div', {className: 'text'});
    for (const paragraph of demo.text.split('\n\n').filter((p) => p)) {
      const formula = /^\s{2,}|^[^.]{0,80}=[^.]{0,120}$/.test(paragraph);
      text.append(element('p', {className: formula ? 'formula' : '', textContent: paragraph.trim()}));
    }
    const details = element('details', {id: 'lesson', open: false}, element('summary', {textContent: 'What this shows, what to try'}), text);
    details.addEventListener('toggle', () => {
      void fetch('lessons.json').then((answer) => answer.json() as Promise<Record<string, Lesson | undefined>>).then((all) => {
        const found = all[demo.demo] ?? (/^(common|box3d|box2d|jolt)-/.test(demo.demo) ? all.stress : undefined);
        if (!found) return;
        if (found.formulas) text.append(element('h3', {textContent: 'Formulas'}), ...found.formulas.map((one) => element('p', {className: 'formula', textContent: one})));
        const symbols = Object.entries(found.symbols);
        if (symbols.length > 0) text.append(element('h3', {textContent: 'Symbols'}), element('dl', {className: 'symbols'}, ...symbols.flatMap(([sign, meaning]) => [element('dt', {textContent: sign}), element('dd', {textContent: meaning})])));
        text.append(element('h3', {textContent: 'Try'}), element('ul', {}, ...found.try.map((one) => element('li', {textContent: one}))),
          element('h3', {textContent: 'Where the model ends'}), element('p', {textContent: found.ends}));
      }, () => {});
    }, {once: true});
    details.hidden = demo.text === '';
    return details;
  }

  /** The C++ that makes the demo, as it was compiled; fetched when somebody wants to see it. */
  private source(demo: string): HTMLElement {
    const code = element('pre', {className: 'source', tabIndex: 0, textContent: '…'});
    const details = element('details', {id: 'source', open: false, hidden: demo.endsWith('.json')}, element('summary', {textContent: `The C++ that ${demo.startsWith('scene:') ? 'runs' : 'makes'} it`}), code);
    details.addEventListener('toggle', () => {
      void fetch('sources.json').then((answer) => answer.json() as Promise<Record<string, {file: string; code: string} | undefined>>).then((all) => {
        const found = all[demo.startsWith('scene:') ? 'scene' : demo];
        code.textContent = found ? `// ${found.file}\n${found.code}` : 'The page that was built has no source of this one.';
      }, () => { code.textContent = 'The source cannot be loaded from here.'; });
    }, {once: true});
    return details;
  }

  /** The scene as a file: as it was read, or, of a demo that a program makes, its world as it is now. Asked for when somebody wants to see it. */
  private sceneFile(): HTMLElement {
    const text = element('pre', {className: 'source', tabIndex: 0, textContent: '…'});
    const details = element('details', {id: 'scene-file', open: false}, element('summary', {textContent: 'The scene file'}), element('p', {className: 'note'}), text);
    details.addEventListener('toggle', () => { if (details.open) this.send({type: 'source'}); });
    return details;
  }

  showScene(text: string, written: boolean): void {
    const details = document.getElementById('scene-file');
    if (!details) return;
    details.querySelector('p')!.textContent = `${written ? 'Bodies, joints and settings of the world as it is now. ' : ''}“Edit scene” opens it beside the view.`;
    details.querySelector('pre')!.textContent = text.length > LONG ? `${text.slice(0, LONG)}\n… (${(text.length / 1000).toFixed(0)} kB in all)` : text;
  }

  setValues(values: Record<string, number>): void {
    for (const [name, value] of Object.entries(values)) this.shown.get(name)?.(value);
  }

  /** A list of names; of no and yes a box to tick. */
  private choice(p: Parameter, choices: string[]): HTMLElement {
    const id = `parameter-${p.name}`, label = labelOf(p), ticks = choices.join() === 'no,yes';
    const box = element('input', {type: 'checkbox', id, title: p.description});
    const list = element('select', {id, title: p.description}, ...choices.map((name, i) => element('option', {value: String(p.minimum + i), textContent: name})));
    const show = (si: number) => { p.value = si; box.checked = si !== p.minimum; list.value = String(Math.round(si)); };
    const change = (value: number) => { p.value = value; this.send({type: 'set', name: p.name, value}); };
    box.addEventListener('change', () => change(p.minimum + Number(box.checked)));
    list.addEventListener('change', () => change(Number(list.value)));
    this.shown.set(p.name, show);
    show(p.value);
    return element('div', {className: 'parameter choice', title: p.description}, element('label', {htmlFor: id, textContent: label}), ticks ? box : list);
  }

  private slider(p: Parameter): HTMLElement {
    const id = `parameter-${p.name}`, unit = unitOf(p), label = labelOf(p);
    const shownStep = Math.abs(p.step * p.display_factor) || 'any';
    const range = element('input', {type: 'range', id, min: String(toDisplay(p, p.minimum)), max: String(toDisplay(p, p.maximum)), title: p.description});
    range.step = String(shownStep);
    const number = element('input', {type: 'number', className: 'number', min: range.min, max: range.max, title: p.description});
    number.step = 'any';
    number.setAttribute('aria-label', `${label} in ${unit || 'units of one'}`);
    const show = (si: number) => {
      const value = short(toDisplay(p, si), 5);
      range.value = String(toDisplay(p, si));
      range.setAttribute('aria-valuetext', `${value} ${unit}`);
      if (document.activeElement !== number) number.value = String(Number(toDisplay(p, si).toPrecision(5)));
    };
    const change = (text: string) => {
      const shown = Number(text);
      if (text === '' || !Number.isFinite(shown)) { show(p.value); return; }
      p.value = Math.min(p.maximum, Math.max(p.minimum, fromDisplay(p, shown)));
      show(p.value);
      this.send({type: 'set', name: p.name, value: p.value});
    };
    // A parameter that is not live restarts the demo: wait until the slider is let go.
    range.addEventListener(p.live ? 'input' : 'change', () => change(range.value));
    if (!p.live) range.addEventListener('input', () => { number.value = String(Number(Number(range.value).toPrecision(5))); });
    number.addEventListener('change', () => change(number.value));
    this.shown.set(p.name, (si) => { p.value = si; show(si); });
    show(p.value);
    return element('div', {className: 'parameter', title: p.description},
      element('label', {htmlFor: id, textContent: label}),
      element('span', {className: 'quantity'}, number, element('span', {className: 'unit', textContent: unit})), range);
  }

  private inputs(demo: Opened): void {
    const host = document.getElementById('inputs')!;
    host.replaceChildren(...demo.inputs.map((input) => {
      const key = [...new Set(input.keys.map((k) => k.replace(/^Shift(Left|Right)$/, 'shift').replace(/^Key|^Digit/, '').replace('ArrowUp', '↑').replace('ArrowDown', '↓').replace('ArrowLeft', '←').replace('ArrowRight', '→').replace('Space', 'space').replace('Enter', 'enter')))].join(' ');
      const button = element('button', {type: 'button', title: `${input.label} (${key})`}, input.label, ' ', element('kbd', {textContent: key}));
      const press = (value: number) => this.send({type: 'input', action: input.action, value});
      button.onpointerdown = (event) => { button.setPointerCapture(event.pointerId); press(input.value); };
      if (input.kind === 'hold') button.onpointerup = button.onpointercancel = () => press(0);
      button.onclick = (event) => { if (event.detail === 0) { press(input.value); if (input.kind === 'hold') setTimeout(() => press(0), 250); } };
      return button;
    }));
    host.hidden = demo.inputs.length === 0;
  }

  budget(n: Numbers): void {
    const size = (v: number[]) => Math.hypot(...v);
    this.rows('budget', [
      ['Momentum', `${short(size(n.momentum))} kg·m/s`], ['Angular momentum', `${short(size(n.angular_momentum))} kg·m²/s`], ['Mass', `${short(n.mass)} kg`],
      ['Worst joint gap', `${short(1000 * n.joint_error, 3)} mm`], ['Pull of the hand', `${short(n.hand_force)} N`], ['Memory', `${short(n.bytes / 1e6, 3)} MB`],
      ['Arrows: 1 m stands for', `${short(1 / n.arrows.velocity, 3)} m/s, ${short(1 / n.arrows.force, 3)} N, ${short(1 / n.arrows.impulse, 3)} N·s`],
    ]);
  }

  numbers(stats: Stats, step: number): void {
    const rows: [string, string][] = [
      ['Bodies', `${stats.bodies} (${stats.awake} awake)`], ['Contacts', String(stats.contacts)], ['Joints', String(stats.joints)],
      ['Islands', String(stats.islands)], ['Step', `${stats.stepMs.toFixed(2)} ms on ${stats.threads} thread${stats.threads === 1 ? '' : 's'}`],
      ['Real time', `${short(stats.realTimeFactor, 3)}×`], ['Kinetic energy', `${short(stats.kinetic)} J`],
      ['Potential energy', `${short(stats.potential)} J`], ['Worst penetration', `${short(1000 * stats.penetration, 3)} mm`], ['State hash', stats.hash],
    ];
    this.rows('numbers', rows);
    document.getElementById('numbers')!.dataset.step = String(step);
  }

  private rows(id: string, rows: [string, string][]): void {
    const list = document.getElementById(id)!;
    if (list.children.length !== 2 * rows.length)
      list.replaceChildren(...rows.flatMap(([name]) => [element('dt', {textContent: name}), element('dd')]));
    rows.forEach(([, value], i) => { list.children[2 * i + 1].textContent = value; });
  }
}
