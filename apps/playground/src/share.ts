// What leaves the page and what comes into it: links, pictures, recordings, files dropped on it.
import {byId, download, element} from './dom';
import type {Opened, Verified} from './protocol';
import type {Source} from './source';
import type {Viewer} from './viewer';

/** What a link restores: `#demo?parameter=value&step=n&camera=x,y,z,x,y,z` (position, target). */
export interface Link { demo: string; parameters: Record<string, number>; step?: number; camera?: number[] }

export function readLink(hash: string): Link {
  const [demo, query] = hash.replace(/^#/, '').split('?');
  const link: Link = {demo: decodeURIComponent(demo), parameters: {}};
  for (const [name, text] of new URLSearchParams(query ?? '')) {
    const numbers = text.split(',').map(Number);
    if (text === '' || !numbers.every(Number.isFinite)) continue;
    if (name === 'camera') { if (numbers.length === 6) link.camera = numbers; }
    else if (name === 'step') link.step = Math.max(0, Math.min(36000, Math.floor(numbers[0])));
    else link.parameters[name] = numbers[0];
  }
  return link;
}

export function writeLink(link: Link): string {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(link.parameters)) query.set(name, String(value));
  if (link.step !== undefined) query.set('step', String(link.step));
  if (link.camera) query.set('camera', link.camera.map((x) => Number(x.toPrecision(6))).join(','));
  const text = query.toString().replace(/%2C/g, ',');
  return `#${encodeURIComponent(link.demo)}${text ? `?${text}` : ''}`;
}

/** A run that is opened at a step is paused there. */
export function playTo(send: (message: object) => void, step: number): void {
  send({type: 'pause'});
  send({type: 'restart'});  // the run has begun before the pause came
  for (let left = step; left > 0; left -= 1000) send({type: 'step', count: Math.min(1000, left)});
}

const PART = 1 << 20;  // bytes of a message that carries a part of a file

export class Share {
  private recording = false;
  private check = element('button', {
    type: 'button', textContent: 'Check recording', hidden: true, title: 'Run it again from what opened it, and compare every step',
    onclick: () => this.source.send({type: 'verify'}),
  });
  opened?: Opened;
  step = 0;
  /** The text of the scene that is open, where it came from a file; for a new connection and for errors. */
  scene?: {name: string; text: string};

  constructor(private viewer: Viewer, private source: Source, private say: (text: string, wrong?: boolean) => void, edit: () => void, compare: () => void) {
    const button = (label: string, title: string, act: () => void) => element('button', {type: 'button', textContent: label, title, onclick: act});
    const chooser = element('input', {type: 'file', hidden: true, accept: '.json,.carom-rec,.obj,.stl,.glb,.gltf,.eng', onchange: () => { for (const file of chooser.files ?? []) void this.openFile(file); }});
    chooser.setAttribute('aria-label', 'A scene, a recording, a mesh or a rocket motor');
    byId('share').replaceChildren(
      button('Copy link', 'A link to this demo with these values, this view and this moment', () => this.copyLink()),
      button('Picture', 'Save what the view shows', () => { void this.picture(); }),
      button('Record', 'Write a recording from now on; again: save it', () => this.source.send({type: 'record', on: !this.recording})),
      button('Open file', 'A scene (JSON), a recording, a closed mesh (OBJ, STL, glTF) that falls and breaks, or a thrust file (.eng) whose motors lift rockets; it can also be dropped on the page', () => chooser.click()),
      this.check, button('Edit scene', 'The scene as a file beside the view; edits act at once (E)', edit),
      button('Compare', 'Two settings side by side, in step (C)', compare), chooser);
    addEventListener('dragover', (event) => { event.preventDefault(); document.body.classList.add('dropping'); });
    addEventListener('dragleave', (event) => { if (!event.relatedTarget) document.body.classList.remove('dropping'); });
    addEventListener('drop', (event) => {
      event.preventDefault();
      document.body.classList.remove('dropping');
      const file = event.dataTransfer?.files[0];
      if (file) void this.openFile(file);
    });
  }

  link(): Link | undefined {
    if (!this.opened) return undefined;
    return {demo: this.opened.demo, parameters: Object.fromEntries(this.opened.parameters.map((p) => [p.name, p.value])), step: this.step, camera: this.viewer.viewpoint};
  }

  private copyLink(): void {
    const link = this.link();
    if (!link) return;
    history.replaceState(null, '', writeLink(link));
    // A page that came without encryption from another machine has no clipboard.
    const copied = navigator.clipboard?.writeText(location.href) ?? Promise.reject(new Error('no clipboard'));
    copied.then(() => this.say('The link is in the clipboard.'), () => this.say('The link is in the address line.'));
  }

  private name(suffix: string): string { return `carom-${(this.opened?.demo ?? 'scene').replace(/[^\w-]/g, '_')}-${this.step}.${suffix}`; }

  private async picture(): Promise<void> {
    const data = await this.viewer.picture();
    if (data) download(this.name('png'), data);
  }

  /** A recording that is open can be run again and compared. */
  playing(is: boolean): void { this.check.hidden = !is; }
  verified(report: Verified): void { this.say(`Run again: ${report.message}.`, !report.equal); }

  /** The host says whether it records with the file that ends it. */
  recorded(on: boolean): void {
    this.recording = on;
    const button = byId('share').children[2] as HTMLElement;
    button.textContent = on ? 'Save recording' : 'Record';
    button.setAttribute('aria-pressed', String(on));
  }
  file(bytes: ArrayBuffer): void {
    this.recorded(false);
    download(this.name('carom-rec'), new Blob([bytes]));
  }

  async openFile(file: File): Promise<void> {
    if (file.size > 64 << 20) { this.say(`${file.name} has ${(file.size / 1e6).toFixed(0)} MB; expected at most 67 MB.`, true); return; }
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (/\.(obj|stl|glb|gltf|eng)$/i.test(file.name)) {
      try {
        const text = /\.eng$/i.test(file.name)
          ? (await import('./motor')).sceneOfMotors(file.name, new TextDecoder().decode(bytes))
          : await (await import('./mesh')).sceneOfMesh(file.name, bytes.buffer);
        this.openText(`${file.name}.json`, text);
      } catch (error) { this.say(error instanceof Error ? error.message : String(error)); }
      return;
    }
    if (new TextDecoder().decode(bytes.subarray(0, 8)) !== 'CAROMREC') {
      this.openText(file.name, new TextDecoder().decode(bytes));
      return;
    }
    for (let at = 0; at < bytes.length; at += PART) {
      const part = new Uint8Array(4 + Math.min(PART, bytes.length - at));
      part.set([3, at + PART >= bytes.length ? 1 : 0, 0, 0]);
      part.set(bytes.subarray(at, at + PART), 4);
      this.source.sendBytes(part.buffer);
    }
  }

  private openText(name: string, text: string): void {
    this.scene = {name, text};
    this.source.send({type: 'open_scene', name, text});
  }

  /** An error that names a line of the dropped file is shown with that line. */
  withLine(message: string): string {
    const found = this.scene && message.startsWith(`${this.scene.name}:`) ? message.slice(this.scene.name.length).match(/^:(\d+):/) : null;
    const line = found && this.scene?.text.split('\n')[Number(found[1]) - 1];
    return found && line !== undefined && line !== null ? `${message}\n\n${found[1]} │ ${line.trim().slice(0, 200)}` : message;
  }
}
