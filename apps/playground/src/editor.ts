// The scene editor: JSON beside the view, with the keys and values that the schema knows, errors at their lines, and
// every edit that holds together acting at once. Loaded when it is first opened.
import {autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap, type Completion, type CompletionContext, type CompletionResult} from '@codemirror/autocomplete';
import {defaultKeymap, history, historyKeymap, indentWithTab} from '@codemirror/commands';
import {json} from '@codemirror/lang-json';
import {bracketMatching, defaultHighlightStyle, foldGutter, foldKeymap, indentOnInput, syntaxHighlighting, syntaxTree} from '@codemirror/language';
import {lintGutter, lintKeymap, setDiagnostics} from '@codemirror/lint';
import {EditorState, type Text} from '@codemirror/state';
import {drawSelection, EditorView, highlightActiveLine, hoverTooltip, keymap, lineNumbers} from '@codemirror/view';
import type {SyntaxNode} from '@lezer/common';
import {keysAt, kindOf, schemasAt, types, valuesAt} from './schema';

const VALUES = new Set(['Object', 'Array', 'String', 'Number', 'True', 'False', 'Null']);

const unquoted = (text: string) => text.replace(/^"|"$/g, '');

/** Keys and places from the document's root to a node. */
function pathTo(node: SyntaxNode, text: Text): (string | number)[] {
  const path: (string | number)[] = [];
  for (let at: SyntaxNode | null = node; at; at = at.parent) {
    if (at.name === 'Property') {
      const name = at.getChild('PropertyName');
      if (name) path.unshift(unquoted(text.sliceString(name.from, name.to)));
    } else if (at.parent?.name === 'Array' && VALUES.has(at.name)) {
      let place = 0;
      for (let before = at.prevSibling; before; before = before.prevSibling) if (VALUES.has(before.name)) ++place;
      path.unshift(place);
    }
  }
  return path;
}

/** What a new key is given to begin with. */
const beginning: Record<string, string> = {array: '[]', object: '{}', string: '""'};

export function complete(context: CompletionContext): CompletionResult | null {
  const text = context.state.doc, node = syntaxTree(context.state).resolveInner(context.pos, -1);
  let holder: SyntaxNode | null = node;
  const word = context.matchBefore(/"?[\w$]*/);
  const from = word ? word.from : context.pos;
  // After a colon, or within a value, a value is wanted; elsewhere within an object a key.
  const before = text.sliceString(Math.max(0, from - 80), from).trimEnd();
  const property = node.name === 'Property' ? node : node.parent?.name === 'Property' && node.name !== 'PropertyName' ? node.parent : null;
  if (before.endsWith(':') || (before.endsWith('[') || before.endsWith(',')) && enclosing(node)?.name === 'Array') {
    const path = before.endsWith(':') && property ? pathTo(property, text) : [...pathTo(enclosing(node)!, text), 0];
    const values = valuesAt(path);
    if (values.length === 0) return null;
    return {from, to: endOfWord(text, context.pos), options: values.map((v) => ({label: JSON.stringify(v), type: 'enum'}))};
  }
  if (!word && !context.explicit) return null;
  while (holder && holder.name !== 'Object') holder = holder.parent;
  if (!holder || !(before.endsWith('{') || before.endsWith(','))) return null;
  const there = new Set(holder.getChildren('Property').map((p) => p.getChild('PropertyName')).filter((n): n is SyntaxNode => n !== null && !(n.from <= context.pos && context.pos <= n.to)).map((n) => unquoted(text.sliceString(n.from, n.to))));
  const options: Completion[] = keysAt(pathTo(holder, text)).filter((k) => !there.has(k.name)).map((key) => {
    const given = beginning[types(key.schema)[0]] ?? (key.schema.enum ? '""' : '');
    return {
      label: `"${key.name}"`, type: 'property', detail: kindOf(key.schema), info: key.schema.description, boost: key.required ? 2 : key.name === 'type' ? 1 : 0,
      apply: (view, _completion, start, end) => {
        const followed = /^\s*:/.test(text.sliceString(end, end + 20));
        const insert = `"${key.name}"${followed ? '' : `: ${given}`}`;
        view.dispatch({changes: {from: start, to: end, insert}, selection: {anchor: start + insert.length - (followed || given === '' ? 0 : 1)}});
      },
    };
  });
  return {from, to: endOfWord(text, context.pos), options, validFor: /^"?[\w$]*"?$/};
}
function enclosing(node: SyntaxNode): SyntaxNode | null {
  let at: SyntaxNode | null = node;
  while (at && at.name !== 'Array' && at.name !== 'Object') at = at.parent;
  return at;
}
function endOfWord(text: Text, at: number): number {
  return at + (text.sliceString(at, at + 64).match(/^[\w$]*"?/)?.[0].length ?? 0);
}

const explain = hoverTooltip((view, at) => {
  const name = syntaxTree(view.state).resolveInner(at, 1);
  if (name.name !== 'PropertyName' || !name.parent) return null;
  const schema = schemasAt(pathTo(name.parent, view.state.doc)).find((s) => s.description);
  if (!schema?.description) return null;
  return {pos: name.from, end: name.to, create: () => {
    const dom = document.createElement('div');
    dom.className = 'cm-explain';
    dom.textContent = schema.description!;
    return {dom};
  }};
});

/** A scene to begin with where there is none to edit. */
export const STARTER = `{
  "name": "mine",
  "dimension": 3,
  "ground": "0 m",
  "bodies": [
    {"name": "floor", "type": "fixed", "shape": {"type": "plane", "normal": [0, 1, 0]}},
    {
      "name": "crate",
      "position": [0, "3 m", 0],
      "mass": "20 kg",
      "shape": {"type": "box", "size": ["1 m", "1 m", "1 m"]}
    }
  ]
}
`;

export class SceneEditor {
  private view: EditorView;
  private timer?: ReturnType<typeof setTimeout>;
  private quiet = false;

  constructor(parent: HTMLElement, private apply: (text: string) => void) {
    const theme = EditorView.theme({'&': {height: '100%', fontSize: '13px', backgroundColor: 'var(--panel)', color: 'var(--ink)'}, '.cm-content': {caretColor: 'var(--ink)'}, '.cm-gutters': {backgroundColor: 'transparent', color: 'var(--ink-soft)', border: '0'}, '.cm-activeLine': {backgroundColor: 'rgb(127 127 127 / 0.1)'}, '.cm-scroller': {overflow: 'auto'}});
    this.view = new EditorView({parent, state: EditorState.create({doc: '', extensions: [
      lineNumbers(), foldGutter(), lintGutter(), history(), drawSelection(), indentOnInput(), bracketMatching(), closeBrackets(), highlightActiveLine(),
      syntaxHighlighting(defaultHighlightStyle), json(), autocompletion({override: [complete], activateOnTyping: true}), explain, theme, EditorView.lineWrapping,
      EditorView.contentAttributes.of({'aria-label': 'Scene file, JSON'}),
      keymap.of([...closeBracketsKeymap, ...completionKeymap, ...lintKeymap, ...foldKeymap, ...historyKeymap, ...defaultKeymap, indentWithTab]),
      EditorView.updateListener.of((update) => { if (update.docChanged && !this.quiet) this.changed(); }),
    ]})});
  }

  get text(): string { return this.view.state.doc.toString(); }
  set text(text: string) {
    this.quiet = true;
    this.view.dispatch({changes: {from: 0, to: this.view.state.doc.length, insert: text}});
    this.view.dispatch(setDiagnostics(this.view.state, []));
    this.quiet = false;
  }
  focus(): void { this.view.focus(); }
  goTo(line: number): void {
    const at = this.view.state.doc.line(Math.min(Math.max(1, line), this.view.state.doc.lines));
    this.view.dispatch({selection: {anchor: at.from}, effects: EditorView.scrollIntoView(at.from, {y: 'center'})});
    this.view.focus();
  }

  /** Half a second after the last key what is written is tried. */
  private changed(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.apply(this.text), 500);
  }

  /** The host's verdict: nothing, or what is wrong at which line (1 is the first; 0: nowhere in particular). */
  verdict(message?: string, line = 0): void {
    const state = this.view.state, at = state.doc.line(Math.min(Math.max(1, line), state.doc.lines));
    const from = at.from + (at.text.length - at.text.trimStart().length);
    this.view.dispatch(setDiagnostics(state, message ? [{from, to: Math.max(from, at.to), severity: 'error', message}] : []));
  }
}
