// The pane of the scene editor: opens and closes it, asks for the open scene's text, and hands edits to the engine.
import {byId, download} from './dom';
import type {SceneEditor} from './editor';
import type {Opened} from './protocol';

export class Editing {
  private editor?: SceneEditor;
  private name = 'scene.json';
  private wrongLine = 0;
  opened?: Opened;

  /** `send` to the host; `keep` is told before a scene is opened anew, so that the view stays where it is. */
  constructor(private send: (message: object) => void, private keep: (name: string, text: string) => void) {
    byId('edit-close').onclick = () => this.close();
    byId('edit-save').onclick = () => download(this.name, new Blob([this.editor?.text ?? '']));
    const status = byId('edit-status'), goToMistake = () => { if (this.wrongLine > 0) this.editor?.goTo(this.wrongLine); };
    status.onclick = goToMistake;
    status.onkeydown = (event) => { if (event.key === 'Enter') { event.preventDefault(); goToMistake(); } };
    byId('edit-new').onclick = () => { void this.fill('', undefined); };
  }

  get active(): boolean { return !byId('editor').hidden; }

  async open(): Promise<void> {
    byId('editor').hidden = false;
    document.body.classList.add('editing');
    if (!this.editor) {
      const {SceneEditor} = await import('./editor');
      this.editor = new SceneEditor(byId('edit-text'), (text) => this.apply(text));
    }
    this.send({type: 'source'});
    this.editor.focus();
  }

  close(): void {
    byId('editor').hidden = true;
    document.body.classList.remove('editing');
  }

  /** The text of the open scene, or of a program's world (`written`); without either there is one to begin with. */
  async fill(name: string, text: string | undefined, written = false): Promise<void> {
    const {STARTER} = await import('./editor');
    if (!this.editor) return;
    this.name = text === undefined ? 'scene.json' : name.endsWith('.json') ? name : `${name}.json`;
    this.editor.text = text ?? STARTER;
    this.say(text === undefined ? 'A new scene. Ctrl-Space shows what may stand here.' : written ? `${this.name} · the demo’s world as it is now; an edit makes a scene of it` : this.name);
    if (text === undefined) this.apply(this.editor.text);
  }

  private apply(text: string): void {
    this.keep(this.name, text);
    this.send({type: 'open_scene', name: this.name, text});
  }

  accepted(): void {
    if (!this.active) return;
    this.wrongLine = 0;
    this.editor?.verdict();
    this.say(`${this.name} · runs`);
  }

  /** True where the error is one of the edited text; it is then shown at its line. */
  refused(message: string): boolean {
    if (!this.active || !message.startsWith(this.name)) return false;
    const [, line, rest] = message.slice(this.name.length).match(/^:(\d+):\s*([^]*)$/) ?? [null, '0', message];
    this.wrongLine = Number(line);
    this.editor?.verdict(rest ?? message, this.wrongLine);
    this.say(line === '0' ? rest! : `line ${line}: ${rest}`, true);
    return true;
  }

  private say(text: string, wrong = false): void {
    const status = byId('edit-status');
    status.textContent = text;
    status.classList.toggle('wrong', wrong);
  }
}
