// The demos to choose from: the start page with pictures, grouped by the subject's chapters, and the same list beside
// the view.
import {byId, element} from './dom';
import type {DemoSummary} from './protocol';

/** The subject's order: the chapter that most demos of a group begin with. What goes beyond the chapters comes after them. */
function place(demos: DemoSummary[]): number {
  const count = new Map<number, number>();
  for (const demo of demos) {
    const chapter = Math.floor(Number.parseFloat(demo.chapter));
    if (Number.isFinite(chapter)) count.set(chapter, (count.get(chapter) ?? 0) + 1);
  }
  return [...count].sort((a, b) => b[1] - a[1] || a[0] - b[0])[0]?.[0] ?? 99;
}
/** "13, 14" and "13" are "13, 14". */
function chaptersOf(demos: DemoSummary[]): string {
  const numbers = new Set(demos.flatMap((d) => (d.chapter.match(/\d+(\.\d+)?/g) ?? []).map((n) => Math.floor(Number(n)))));
  const sorted = [...numbers].sort((a, b) => a - b);
  return sorted.length === 0 ? '' : `chapter${sorted.length > 1 ? 's' : ''} ${sorted.join(', ')}`;
}
const pictures = new Set(document.querySelector<HTMLMetaElement>('meta[name=thumbnails]')?.content.split(' ').filter((id) => id));
const pictureOf = (id: string) => `thumbnails/${id.replace(/[^\w-]/g, '-')}.png`;
/** What a visitor may begin with: one of each kind of wonder. */
const HIGHLIGHTS = ['wrecking-ball', 'glass-pane', 'fluid-tank', 'pool-table', 'powered_ragdoll', 'trebuchet'];
export const narrow = () => matchMedia('(max-width: 800px)').matches;

function section(i: number, chapter: number, ...children: Node[]): HTMLElement {
  const made = element('section', {id: `group-${i}`}, ...children);
  made.dataset.chapter = String(chapter);
  return made;
}

export class Gallery {
  private groups = new Map<string, DemoSummary[]>();

  constructor(private open: (demo: string) => void) {
    byId<HTMLInputElement>('search').oninput = (event) => this.search((event.target as HTMLInputElement).value);
    byId('search').addEventListener('keydown', (event) => {
      // Enter opens what is found first.
      if (event.key !== 'Enter') return;
      byId('demo-list').querySelector<HTMLAnchorElement>('section:not([hidden]) li:not([hidden]) a')?.click();
    });
  }

  get shown(): boolean { return document.body.classList.contains('start'); }
  set shown(on: boolean) {
    document.body.classList.toggle('start', on);
    if (on) document.title = 'Carom playground';
  }

  list(demos: DemoSummary[]): void {
    this.groups.clear();
    for (const demo of demos) this.groups.set(demo.group, [...(this.groups.get(demo.group) ?? []), demo]);
    const ordered = [...this.groups].sort((a, b) => place(a[1]) - place(b[1]));
    const first = HIGHLIGHTS.flatMap((id) => demos.filter((demo) => demo.id === id && pictures.has(id)));
    byId('highlights').replaceChildren(...first.map((demo) => element('li', {}, this.link(demo, element('img', {src: pictureOf(demo.id), alt: '', width: 400, height: 250}), element('span', {className: 'name', textContent: demo.title})))));
    byId('demo-count').textContent = `${demos.length} demos of ${this.groups.size} kinds.`;
    byId('demo-list').replaceChildren(...ordered.map(([group, list], i) => section(i, place(list),
      element('ul', {}, ...list.map((demo) => this.card(demo))), element('h2', {}, group, ' ', element('small', {textContent: chaptersOf(list)})))));
    this.head();
    byId('chapters').replaceChildren(...ordered.map(([group], i) => element('button', {type: 'button', textContent: group, onclick: () => {
      byId(`group-${i}`).querySelector('h2')!.scrollIntoView({behavior: matchMedia('(prefers-reduced-motion: reduce)').matches ? 'auto' : 'smooth'});
      byId(`group-${i}`).querySelector('a')?.focus({preventScroll: true});
    }})));
  }

  private link(demo: DemoSummary, ...children: Node[]): HTMLAnchorElement {
    const link = element('a', {href: `#${encodeURIComponent(demo.id)}`}, ...children);
    link.dataset.demo = demo.id;
    link.onclick = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;  // a tab of its own
      event.preventDefault();
      this.open(demo.id);
    };
    return link;
  }

  private card(demo: DemoSummary): HTMLElement {
    const picture = pictures.has(demo.id) ? element('img', {src: pictureOf(demo.id), alt: '', loading: 'lazy', decoding: 'async', width: 400, height: 250}) : element('span', {className: 'no-picture'});
    return element('li', {}, this.link(demo, picture, element('span', {className: 'name', textContent: demo.title}), element('small', {textContent: demo.summary})));
  }

  /** The cards of all groups follow each other without a gap: a group's name stands in the first that is shown. */
  private head(): void {
    for (const section of byId('demo-list').querySelectorAll('section')) section.querySelector('li:not([hidden])')?.prepend(section.querySelector('h2')!);
  }

  mark(demo: string): void {
    for (const link of byId('demo-list').querySelectorAll('a')) if (link.dataset.demo === demo) link.setAttribute('aria-current', 'page'); else link.removeAttribute('aria-current');
  }

  /** Shows the demos whose title, summary or group holds every word. */
  private search(text: string): void {
    const words = text.toLowerCase().split(/\s+/).filter((word) => word);
    let found = 0;
    for (const section of byId('demo-list').querySelectorAll('section')) {
      const group = section.querySelector('h2')!.textContent!.toLowerCase();
      let shown = 0;
      for (const item of section.querySelectorAll('li')) {
        item.hidden = !words.every((word) => item.textContent!.toLowerCase().includes(word) || group.includes(word));
        if (!item.hidden) ++shown;
      }
      section.hidden = shown === 0;
      found += shown;
    }
    byId('highlights').hidden = words.length > 0;
    this.head();
    byId('nothing-found').hidden = found > 0;
  }
}
