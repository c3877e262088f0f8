// Two settings side by side, in step: the right half is this page once more, in a frame, whose engine steps only as far
// as the left one has come. Both get the same input; each has its own values.
import {byId, element} from './dom';
import type {Opened, Parameter} from './protocol';
import {writeLink, type Link} from './share';

type Sample = {plot: number; series: number; x: number; y: number};
/** What the left page tells the right one, and back. */
type Down = {type: 'follow'; step: number} | {type: 'restart'} | {type: 'view'; viewpoint: number[]} | {type: 'send'; message: object};
type Up = {type: 'ready'} | {type: 'values'; values: Record<string, number>} | {type: 'samples'; samples: Sample[]; step: number};
interface Envelope { carom: 'compare'; body: Down | Up }

export const isTwin = new URLSearchParams(location.search).has('twin');

/** The left page's side. */
export class Compare {
  private frame?: HTMLIFrameElement;
  private ready = false;
  private step = 0;
  private seen = '';
  private right: Record<string, number> = {};
  private left: Record<string, number> = {};
  side: 'A' | 'B' = 'A';
  opened?: Opened;
  twinStep = 0;

  constructor(private link: () => Link | undefined, private show: (values: Record<string, number>) => void, private plot: (samples: Sample[]) => void, private begun: () => void) {
    addEventListener('message', (event: MessageEvent<Envelope>) => {
      if (event.source !== this.frame?.contentWindow || event.origin !== location.origin || event.data?.carom !== 'compare') return;
      const body = event.data.body as Up;
      if (body.type === 'ready') { this.ready = true; this.seen = ''; this.tell({type: 'restart'}); this.tell({type: 'follow', step: this.step}); }
      else if (body.type === 'values') { this.right = body.values; if (this.side === 'B') this.show(this.right); }
      else if (body.type === 'samples') { this.twinStep = body.step; this.plot(body.samples); }
    });
  }

  get active(): boolean { return this.frame !== undefined; }

  toggle(): void { if (this.frame) this.close(); else this.open(); }

  private open(): void {
    const link = this.link();
    if (!link || !this.opened) return;
    this.left = link.parameters;
    this.right = {...link.parameters};
    const address = new URL(location.href);
    address.searchParams.set('twin', '1');
    address.hash = writeLink({demo: link.demo, parameters: link.parameters, step: 0});
    this.frame = element('iframe', {src: address.href, title: 'The same demo with other values'});
    byId('stage').after(this.frame);
    document.body.classList.add('comparing');
    const choose = (side: 'A' | 'B') => element('button', {type: 'button', textContent: side, title: side === 'A' ? 'Change the values of the left view' : 'Change the values of the right view', onclick: () => this.choose(side)});
    byId('parameters').before(element('div', {id: 'compare-sides', role: 'group', ariaLabel: 'Whose values'}, 'Values of ', choose('A'), choose('B')));
    this.choose('A');
    this.begun();
  }

  close(): void {
    if (!this.frame) return;
    if (this.side === 'B') this.choose('A');
    this.frame.remove();
    this.frame = undefined;
    this.ready = false;
    document.getElementById('compare-sides')?.remove();
    document.body.classList.remove('comparing');
  }

  private choose(side: 'A' | 'B'): void {
    if (side === 'B' && this.side === 'A') this.left = this.valuesShown();
    this.side = side;
    for (const button of document.querySelectorAll('#compare-sides button')) button.setAttribute('aria-pressed', String(button.textContent === side));
    this.show(side === 'A' ? this.left : this.right);
  }
  private valuesShown(): Record<string, number> { return Object.fromEntries((this.opened?.parameters ?? []).map((p: Parameter) => [p.name, p.value])); }
  /** The values of the left side, whichever the panel shows. */
  leftValues(): Record<string, number> { return this.side === 'A' ? this.valuesShown() : this.left; }

  private tell(body: Down): void { if (this.ready) this.frame?.contentWindow?.postMessage({carom: 'compare', body} satisfies Envelope, location.origin); }

  /** The left run has come so far. */
  follow(step: number): void {
    if (!this.frame) return;
    if (step < this.step) this.tell({type: 'restart'});
    this.step = step;
    this.tell({type: 'follow', step});
  }
  view(viewpoint: number[]): void {
    if (!this.ready) return;
    const now = viewpoint.map((x) => x.toFixed(4)).join();
    if (now !== this.seen) this.tell({type: 'view', viewpoint});
    this.seen = now;
  }
  /** A message on its way to the left engine: true where it belongs to the right one alone. */
  divert(message: {type?: string; name?: string; value?: number}): boolean {
    if (!this.frame) return false;
    if (message.type === 'input') this.tell({type: 'send', message});
    if (message.type !== 'set' || this.side === 'A') return false;
    this.tell({type: 'send', message});
    return true;
  }
}

/** The right page's side: does what it is told. */
export class Follower {
  private wanted = 0;
  private own = 0;
  private asked = 0;
  private restarting = false;

  constructor(private send: (message: object) => void, private view: (viewpoint: number[]) => void) {
    document.body.classList.add('twin', 'no-demos', 'no-panel');
    addEventListener('message', (event: MessageEvent<Envelope>) => {
      if (event.source !== parent || event.origin !== location.origin || event.data?.carom !== 'compare') return;
      const body = event.data.body as Down;
      if (body.type === 'follow') this.wanted = body.step;
      else if (body.type === 'restart') { this.restarting = true; this.asked = this.wanted = 0; this.send({type: 'restart'}); }
      else if (body.type === 'view') this.view(body.viewpoint);
      else this.send(body.message);
      this.go();
    });
  }
  private tell(body: Up): void { parent.postMessage({carom: 'compare', body} satisfies Envelope, location.origin); }
  opened(): void { this.send({type: 'pause'}); this.tell({type: 'ready'}); }
  values(values: Record<string, number>): void { this.tell({type: 'values', values}); }
  status(step: number): void {
    if (step === 0) { this.restarting = false; this.asked = 0; }
    this.own = step;
    this.go();
  }
  frame(step: number, samples: Sample[]): void { if (step >= this.own) this.tell({type: 'samples', samples, step}); }

  /** One request at a time, and never past where the left one is, even where an answer of before a restart comes late. */
  private go(): void {
    if (this.restarting || this.own < this.asked || this.own >= this.wanted) return;
    this.asked = Math.min(this.wanted, this.own + 100);
    this.send({type: 'step', count: this.asked - this.own, to: this.asked});
  }
}
