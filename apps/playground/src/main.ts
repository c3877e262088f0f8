// The page: joins a source of simulation to the view, the panel, the plots and the user's hands.
import {Hands} from './hands';
import {Panel} from './panel';
import {Plots} from './plots';
import type {DemoSummary, Frame, HostMessage, Mesh, Opened} from './protocol';
import {SocketSource, type Listener} from './source';
import {Viewer} from './viewer';

const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

class Page implements Listener {
  private canvas = byId<HTMLCanvasElement>('view');
  readonly viewer = new Viewer(this.canvas);
  private source = new SocketSource(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`, this);
  private send = (message: object) => this.source.send(message);
  private panel = new Panel(this.send);
  private plots = new Plots(byId('plot'), byId('plot-choice'));
  private hands = new Hands(this.canvas, this.viewer, this.send);
  private demos: DemoSummary[] = [];
  private opened?: Opened;
  private running = true;
  private held = new Map<string, string>();  // key → action

  constructor() {
    byId('run').onclick = () => this.send({type: this.running ? 'pause' : 'run'});
    byId('step').onclick = () => this.send({type: 'step', count: 1});
    byId('restart').onclick = () => this.send({type: 'restart'});
    byId<HTMLSelectElement>('speed').onchange = (event) => this.send({type: 'speed', value: Number((event.target as HTMLSelectElement).value)});
    byId('menu').onclick = () => this.toggle('menu', 'no-demos');
    byId('panel-toggle').onclick = () => this.toggle('panel-toggle', 'no-panel');
    if (matchMedia('(max-width: 800px)').matches) { this.toggle('menu', 'no-demos'); this.toggle('panel-toggle', 'no-panel'); }
    addEventListener('keydown', (event) => this.key(event, true));
    addEventListener('keyup', (event) => this.key(event, false));
    addEventListener('blur', () => this.letGo());
    addEventListener('hashchange', () => {
      const wanted = decodeURIComponent(location.hash.slice(1));
      if (wanted !== this.opened?.demo) this.open(wanted);
    });
    new ResizeObserver(() => this.viewer.resize()).observe(byId('stage'));
    this.frameLoop();
  }

  private toggle(button: string, name: string): void {
    const hidden = document.body.classList.toggle(name);
    byId(button).setAttribute('aria-expanded', String(!hidden));
  }

  private frameLoop = (now = performance.now()) => {
    this.viewer.render(now);
    this.plots.draw();
    requestAnimationFrame(this.frameLoop);
  };

  connected(connected: boolean): void {
    this.notice(connected ? '' : 'The connection to the engine is lost. Trying again…');
    if (!connected) this.hands.releaseAll();
  }

  private notice(text: string): void {
    const notice = byId('notice');
    notice.textContent = text;
    notice.hidden = text === '';
  }

  message(message: HostMessage): void {
    switch (message.type) {
      case 'welcome': {
        this.demos = message.demos;
        this.listDemos();
        const wanted = decodeURIComponent(location.hash.slice(1));
        const known = this.demos.some((d) => d.id === wanted);
        this.open(known ? wanted : this.opened?.demo ?? this.demos[0]?.id);
        break;
      }
      case 'opened': this.show(message); break;
      case 'scene':
        this.viewer.setBodies(message.bodies);
        this.viewer.setGround(message.ground?.level);
        this.plots.restart();
        break;
      case 'bodies':
        if (message.remove?.length) this.viewer.removeBodies(message.remove);
        for (const body of message.add ?? []) this.viewer.addBody(body);
        break;
      case 'grabbed': this.hands.grabbed(message.pointer, message.body, message.point); break;
      case 'status':
        this.running = message.running;
        byId('run').textContent = message.running ? 'Pause' : 'Run';
        byId<HTMLButtonElement>('step').disabled = message.running;
        byId('verdict').textContent = message.message ?? '';
        byId('clock').textContent = `${message.time.toFixed(2)} s · step ${message.step}`;
        break;
      case 'values': this.panel.setValues(message.values); break;
      case 'error':
        this.notice(message.message);
        setTimeout(() => this.notice(''), 6000);
    }
  }

  mesh(mesh: Mesh): void { this.viewer.addMesh(mesh); }

  frame(frame: Frame): void {
    this.viewer.apply(frame);
    for (const s of frame.samples) this.plots.add(s.plot, s.series, s.x, s.y);
    byId('clock').textContent = `${frame.time.toFixed(2)} s · step ${frame.step}`;
    if (frame.stats) this.panel.numbers(frame.stats);
  }

  private open(demo: string | undefined): void {
    if (demo) this.send({type: 'open', demo});
  }

  private show(opened: Opened): void {
    this.opened = opened;
    if (location.hash.slice(1) !== opened.demo) history.replaceState(null, '', `#${encodeURIComponent(opened.demo)}`);
    document.title = `${opened.title} – Carom`;
    byId('title').textContent = opened.title;
    this.notice('');
    this.letGo();
    this.viewer.open(opened.dimension, opened.camera);
    this.panel.open(opened);
    this.plots.open(opened.plots);
    for (const link of byId('demos').querySelectorAll('a')) link.toggleAttribute('aria-current', link.dataset.demo === opened.demo);
  }

  private listDemos(): void {
    const groups = new Map<string, DemoSummary[]>();
    for (const demo of this.demos) groups.set(demo.group, [...(groups.get(demo.group) ?? []), demo]);
    byId('demos').replaceChildren(...[...groups].map(([group, demos]) => {
      const section = document.createElement('section');
      const heading = document.createElement('h2');
      heading.textContent = group;
      const list = document.createElement('ul');
      for (const demo of demos) {
        const link = document.createElement('a');
        link.href = `#${encodeURIComponent(demo.id)}`;
        link.dataset.demo = demo.id;
        const summary = document.createElement('small');
        summary.textContent = demo.summary;
        link.append(demo.title, summary);
        link.onclick = (event) => {
          event.preventDefault();
          this.open(demo.id);
          if (matchMedia('(max-width: 800px)').matches) this.toggle('menu', 'no-demos');
        };
        const item = document.createElement('li');
        item.append(link);
        list.append(item);
      }
      section.append(heading, list);
      return section;
    }));
  }

  private key(event: KeyboardEvent, down: boolean): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target as HTMLElement;
    if (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
    const input = this.opened?.inputs.find((i) => i.keys.includes(event.code));
    if (input) {
      event.preventDefault();
      if (down && !event.repeat) {
        this.send({type: 'input', action: input.action, value: input.value});
        if (input.kind === 'hold') this.held.set(event.code, input.action);
      } else if (!down && this.held.delete(event.code)) this.send({type: 'input', action: input.action, value: 0});
      return;
    }
    if (!down || (target.tagName === 'BUTTON' && event.code === 'Space')) return;
    const actions: Record<string, () => void> = {
      Space: () => byId('run').click(), Period: () => byId('step').click(), KeyR: () => byId('restart').click(),
      KeyD: () => byId('menu').click(), KeyP: () => byId('panel-toggle').click(), Home: () => this.viewer.resetView(),
    };
    const action = actions[event.code];
    if (action) { event.preventDefault(); action(); }
  }

  private letGo(): void {
    for (const action of new Set(this.held.values())) this.send({type: 'input', action, value: 0});
    this.held.clear();
    this.hands.releaseAll();
  }
}

// The tests drive the page through this object; nothing in the page reads it.
(window as unknown as {caromPage: Page}).caromPage = new Page();
