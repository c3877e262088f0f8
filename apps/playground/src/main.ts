// The page: joins a source of simulation to the view, the panel, the plots and the user's hands.
import {byId} from './dom';
import {Compare, Follower, isTwin} from './compare';
import {Editing} from './editing';
import {Gallery, narrow} from './gallery';
import {Gamepads} from './gamepad';
import {Hands} from './hands';
import {Panel} from './panel';
import {Plots} from './plots';
import type {DemoSummary, Frame, HostMessage, Mesh, Opened, PlotDeclaration, Points, Surface} from './protocol';
import {playTo, readLink, Share, writeLink, type Link} from './share';
import {SocketSource, WorkerSource, type Listener, type Source} from './source';
import {Timeline} from './timeline';
import {Timing} from './timing';
import {Tools, type Tool} from './tools';
import {Viewer} from './viewer';
import {showReport} from './why';

/** Who simulates: the built page says so (`./play --web`), `?engine=native` or `?engine=wasm` choose. */
function engineOfPage(listener: Listener): Source {
  const engine = new URLSearchParams(location.search).get('engine') ?? document.querySelector<HTMLMetaElement>('meta[name=engine]')?.content;
  return engine === 'wasm' ? new WorkerSource(listener) : new SocketSource(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws`, listener);
}

/** Every plotted curve once more for the right view; fixed curves stay single. */
function doubled(plots: PlotDeclaration[]): PlotDeclaration[] {
  return plots.map((p) => ({...p, series: [...p.series, ...p.series.map((s) => (s.points ? {...s, points: []} : {...s, name: `${s.name} (B)`, color: undefined}))]}));
}

class Page implements Listener {
  private canvas = byId<HTMLCanvasElement>('view');
  readonly viewer = new Viewer(this.canvas);
  private source: Source = engineOfPage(this);
  private send = (message: object) => { if (!this.compare?.divert(message)) this.source.send(message); };
  private panel = new Panel(this.send);
  private plots = new Plots(byId('plot'), byId('plot-choice'));
  private tools = new Tools(this.viewer, this.send);
  private hands = new Hands(this.canvas, this.viewer, this.tools, this.send);
  private timeline = new Timeline(this.send);
  private timing = new Timing(byId('timing'));
  private share = new Share(this.viewer, this.source, (text, wrong) => this.notice(text, wrong ? 8000 : 4000, wrong), () => { void this.editing.open(); }, () => this.compare?.toggle());
  private editing = new Editing(this.send, (name, text) => {
    // An edit changes the scene, not where one looks from, nor whether it runs.
    this.share.scene = {name, text};
    const same = this.opened?.demo === name || this.opened?.demo === `scene:${name.replace(/\.json$/, '')}`;
    this.wanted = {demo: name, parameters: {}, camera: same ? this.viewer.viewpoint : undefined};
    this.pausedEdit = !this.running && same;
    this.edited = name;
  });
  private compare: Compare | undefined = isTwin ? undefined : new Compare(() => this.share.link(), (values) => this.panel.setValues(values), (samples) => {
    const own = this.opened?.plots ?? [];
    for (const s of samples) this.plots.add(s.plot, (own[s.plot]?.series.length ?? 0) + s.series, s.x, s.y);
  }, () => {
    if (this.opened) this.plots.open(doubled(this.opened.plots));
    this.send({type: 'restart'});
  });
  private follower = isTwin ? new Follower((message) => this.source.send(message), (viewpoint) => { this.viewer.viewpoint = viewpoint; }) : undefined;
  private edited?: string;     // the scene that the editor has opened last
  private pausedEdit = false;  // it was paused, and stays so
  private wanted?: Link;  // what the next `opened` is to restore
  private gamepads = new Gamepads(this.send);
  private gallery = new Gallery((demo) => {
    if (this.gallery.shown) history.pushState(null, '', writeLink({demo, parameters: {}}));  // back leads to the start page
    this.open({demo, parameters: {}});
    if (narrow() && !this.gallery.shown) this.toggle('menu', 'no-demos');
  });
  private demos: DemoSummary[] = [];
  private opened?: Opened;
  private running = true;
  shown = -1;  // the step whose bodies are drawn
  firstPicture = 0;  // ms after the page's load
  private resume = false;  // after that, it goes on
  private lost?: Link;  // what was open when the connection was lost
  private held = new Map<string, string>();  // key → action

  constructor() {
    byId('run').onclick = () => this.send({type: this.running ? 'pause' : 'run'});
    byId('step').onclick = () => this.send({type: 'step', count: 1});
    byId('restart').onclick = () => this.send({type: 'restart'});
    byId<HTMLSelectElement>('speed').onchange = (event) => this.send({type: 'speed', value: Number((event.target as HTMLSelectElement).value)});
    byId('help-button').onclick = () => byId<HTMLDialogElement>('help').showModal();
    byId<HTMLSelectElement>('theme').onchange = (event) => this.theme((event.target as HTMLSelectElement).value);
    byId<HTMLSelectElement>('text-size').onchange = (event) => {
      document.documentElement.dataset.text = (event.target as HTMLSelectElement).value;
      this.plots.redraw();
    };
    this.canvas.addEventListener('dblclick', (event) => this.choose(this.viewer.bodyAt(event.clientX, event.clientY)));
    byId('menu').onclick = () => { if (!this.gallery.shown) this.toggle('menu', 'no-demos'); };
    byId('panel-toggle').onclick = () => this.toggle('panel-toggle', 'no-panel');
    // Beside a demo the list stands where there is room for it; the start page has all of them.
    if (!isTwin && matchMedia('(max-width: 1400px)').matches) this.toggle('menu', 'no-demos');
    if (!isTwin && narrow()) this.toggle('panel-toggle', 'no-panel');
    addEventListener('keydown', (event) => this.key(event, true));
    addEventListener('keyup', (event) => this.key(event, false));
    addEventListener('blur', () => this.letGo());
    addEventListener('hashchange', () => {
      const link = readLink(location.hash);
      if (!link.demo) this.start();
      else if (this.gallery.shown) this.open(link);
      else if (link.demo !== this.opened?.demo || link.step !== undefined || link.camera || Object.keys(link.parameters).length > 0) this.open(link);
    });
    new ResizeObserver(() => this.viewer.resize()).observe(byId('stage'));
    this.frameLoop();
  }

  private theme(name: string): void {
    if (name) document.documentElement.dataset.theme = name; else delete document.documentElement.dataset.theme;
    this.viewer.setTheme();
    this.plots.redraw();
  }

  private choose(id: number): void {
    this.viewer.choose(id);
    this.send({type: 'inspect', body: id});
  }

  private toggle(button: string, name: string): void {
    const hidden = document.body.classList.toggle(name);
    byId(button).setAttribute('aria-expanded', String(!hidden));
  }

  private frameLoop = (now = performance.now()) => {
    this.gamepads.poll();
    if (!this.gallery.shown) this.viewer.render(now);
    if (this.firstPicture === 0 && this.shown >= 0) requestAnimationFrame((then) => { this.firstPicture ||= then; });
    this.plots.draw();
    this.compare?.view(this.viewer.viewpoint);
    requestAnimationFrame(this.frameLoop);
  };

  connected(connected: boolean): void {
    this.notice(connected ? '' : 'The connection to the engine is lost. Trying again…');
    if (connected) return;
    if (this.gallery.shown) return;
    this.lost ??= this.share.link();
    this.resume = this.running;
    if (this.lost?.step && this.lost.step > 3600) delete this.lost.step;
    this.hands.releaseAll();
  }

  /** `wrong`: something failed; otherwise something is done. */
  private notice(text: string, milliseconds = 0, wrong = true): void {
    const notice = byId('notice');
    notice.textContent = text;
    notice.classList.toggle('done', !wrong);
    notice.hidden = text === '';
    clearTimeout(this.noticeTimer);
    if (milliseconds > 0) this.noticeTimer = setTimeout(() => this.notice(''), milliseconds);
  }
  private noticeTimer?: ReturnType<typeof setTimeout>;

  message(message: HostMessage): void {
    switch (message.type) {
      case 'welcome': {
        this.demos = message.demos;
        this.tools.offer(message.layers);
        document.body.classList.toggle('game', message.engine === 'game');  // a running game keeps its own time
        this.gallery.list(this.demos);
        // A connection that was lost comes back to where it was: a run is made by its demo, its values and its steps.
        const link = this.lost ?? readLink(location.hash), scene = this.share.scene;
        this.lost = undefined;
        if (scene && link.demo === scene.name) this.send({type: 'open_scene', ...scene});
        else if (this.demos.some((d) => d.id === link.demo) || message.engine === 'game') this.open(link.demo ? link : {demo: this.demos[0]?.id, parameters: {}});
        else {
          this.start();
          if (link.demo) this.notice(`There is no demo called “${link.demo}”.`, 8000);
        }
        break;
      }
      case 'opened': this.show(message); break;
      case 'scene':
        this.viewer.setBodies(message.bodies);
        this.viewer.setGround(message.ground?.level);
        break;
      case 'bodies':
        if (message.remove?.length) this.viewer.removeBodies(message.remove);
        for (const body of message.add ?? []) this.viewer.addBody(body);
        break;
      case 'numbers':
        this.timing.add(message.stages);
        this.panel.budget(message);
        this.tools.explain(message.legend);
        break;
      case 'verified': this.share.verified(message); break;
      case 'source':
        this.panel.showScene(message.text, message.written === true);
        if (this.editing.active) void this.editing.fill(message.name, message.text || undefined, message.written === true);
        break;
      case 'probed': this.tools.probed(message); break;
      case 'inspected': showReport(message, this.opened?.dt ?? 1 / 60); break;
      case 'grabbed': this.hands.grabbed(message.pointer, message.body, message.point); break;
      case 'status':
        this.running = message.running;
        this.follower?.status(message.step);
        if (!message.running || message.step === 0) this.compare?.follow(message.step);
        byId('run').textContent = message.running ? 'Pause' : 'Run';
        byId<HTMLButtonElement>('step').disabled = message.running;
        byId('verdict').textContent = message.message ?? '';
        if (message.step === 0) this.plots.restart(); else this.plots.cut(message.time);
        this.timeline.status(message.step, message.first, message.last, message.playing === true);
        this.share.step = message.step;
        this.share.recorded(message.recording);
        this.share.playing(message.playing === true);
        byId('clock').textContent = `${message.time.toFixed(2)} s · step ${message.step}`;
        break;
      case 'values':
        if (this.compare?.side !== 'B') this.panel.setValues(message.values);
        this.follower?.values(message.values);
        break;
      case 'error':
        this.timeline.failed();
        if (!this.editing.refused(message.message)) this.notice(this.share.withLine(message.message), 12000);
    }
  }

  mesh(mesh: Mesh): void { this.viewer.addMesh(mesh); }
  points(points: Points): void { this.viewer.setPoints(points); }
  surface(surface: Surface): void { this.viewer.setSurface(surface); }
  file(bytes: ArrayBuffer): void { this.share.file(bytes); }

  frame(frame: Frame): void {
    this.viewer.apply(frame);
    this.shown = frame.step;
    for (const s of frame.samples) this.plots.add(s.plot, s.series, s.x, s.y);
    byId('clock').textContent = `${frame.time.toFixed(2)} s · step ${frame.step}`;
    this.timeline.frame(frame.step);
    this.compare?.follow(frame.step);
    this.follower?.frame(frame.step, frame.samples);
    this.share.step = frame.step;
    if (frame.stats) this.panel.numbers(frame.stats, frame.step);
  }

  /** All demos to choose from; what ran stands still meanwhile. */
  private start(): void {
    if (this.opened && this.running) this.send({type: 'pause'});
    this.compare?.close();
    this.editing.close();
    this.gallery.shown = true;
    this.gallery.mark('');
    this.letGo();
  }

  private open(link: Link): void {
    if (!link.demo) return;
    this.wanted = link;
    this.send({type: 'open', demo: link.demo, parameters: link.parameters});
  }

  private show(opened: Opened): void {
    this.opened = opened;
    this.gallery.shown = false;
    this.shown = -1;
    this.compare?.close();
    if (this.compare) this.compare.opened = opened;
    this.follower?.opened();
    this.share.opened = opened;
    const wanted = this.wanted?.demo === opened.demo ? this.wanted : undefined;
    this.wanted = undefined;
    if (!wanted || Object.keys(wanted.parameters).length === 0) history.replaceState(null, '', writeLink({demo: opened.demo, parameters: {}}));
    document.title = `${opened.title} – Carom`;
    byId('title').textContent = opened.title;
    this.notice('');
    this.letGo();
    this.viewer.open(opened.dimension, opened.camera);
    if (wanted?.camera) this.viewer.viewpoint = wanted.camera;
    if (wanted?.step !== undefined) playTo(this.send, wanted.step);
    if (this.resume) this.send({type: 'run'});
    this.resume = false;
    this.panel.open(opened);
    this.plots.open(opened.plots);
    this.timeline.open(opened.dt);
    this.gamepads.inputs = opened.inputs;
    if (this.pausedEdit) this.send({type: 'pause'});
    this.pausedEdit = false;
    if (opened.demo === this.edited) this.editing.accepted();
    else if (this.editing.active) this.send({type: 'source'});
    this.tools.draw();
    showReport({body: -1} as never, opened.dt);
    this.gallery.mark(opened.demo);
  }

  private key(event: KeyboardEvent, down: boolean): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target as HTMLElement;
    if (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName) || target.isContentEditable) return;
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
      Comma: () => byId('back').click(), KeyF: () => this.viewer.followChosen(), KeyB: () => this.shootAhead(),
      BracketLeft: () => this.choose(this.viewer.neighbour(-1)), BracketRight: () => this.choose(this.viewer.neighbour(1)),
      ...Object.fromEntries(['pull', 'throw', 'ray', 'sphere', 'closest', 'why'].map((tool, i) => [`Digit${i + 1}`, () => this.tools.choose(tool as Tool)])),
      KeyC: () => this.compare?.toggle(),
      KeyE: () => { if (this.editing.active) this.editing.close(); else void this.editing.open(); },
      KeyD: () => byId('menu').click(), KeyP: () => byId('panel-toggle').click(), Home: () => this.viewer.resetView(),
    };
    const action = event.key === '?' ? () => byId('help-button').click() : actions[event.code];
    if (action) { event.preventDefault(); action(); }
  }

  private shootAhead(): void {
    const box = this.canvas.getBoundingClientRect();
    this.tools.shoot(box.left + box.width / 2, box.top + box.height / 2);
  }

  private letGo(): void {
    for (const action of new Set(this.held.values())) this.send({type: 'input', action, value: 0});
    this.held.clear();
    this.hands.releaseAll();
  }
}

try {
  // The tests drive the page through this object; nothing in the page reads it.
  (window as unknown as {caromPage: Page}).caromPage = new Page();
} catch (error) {
  byId('notice').textContent = `This browser cannot show the page: ${error instanceof Error ? error.message : String(error)}.`;
  byId('notice').hidden = false;
  throw error;
}
