// The parts of the engine that come when one of their functions is first called (apps/wasm/split.mjs): in their place
// in the module's table stand functions that load them. A Worker may wait for a file, and so does the call.
// Every instance, and so every thread, has a table and parts of its own.
import {withMemory} from '../../wasm/memory.mjs';

export class Parts {
  private files: Record<string, string> = {};
  private loaded = new Set<string>();
  private main?: WebAssembly.Exports;

  constructor(module: WebAssembly.Module, private shared: boolean) {
    const [list] = WebAssembly.Module.customSections(module, 'parts');
    if (list) this.files = JSON.parse(new TextDecoder().decode(list)) as Record<string, string>;
  }

  /** What the module imports in place of functions that are elsewhere: named by their place in the table. */
  imports(): WebAssembly.Imports {
    return Object.fromEntries(Object.keys(this.files).map((part) => [part, new Proxy({}, {
      get: (_, place: string) => (...values: unknown[]) => {
        this.load(part);
        return (this.table().get(Number(place)) as (...values: unknown[]) => unknown)(...values);
      },
    })]));
  }

  begin(main: WebAssembly.Exports): void {
    this.main = main;
  }

  private table(): WebAssembly.Table {
    return Object.values(this.main!).find((e) => e instanceof WebAssembly.Table) as WebAssembly.Table;
  }

  /** Puts the part's functions into the table. */
  private load(part: string): void {
    if (this.loaded.has(part)) return;
    this.loaded.add(part);
    void new WebAssembly.Instance(this.read(this.files[part]), {main: this.main as unknown as WebAssembly.ModuleImports});
  }

  private read(file: string): WebAssembly.Module {
    const request = new XMLHttpRequest();
    request.open('GET', file, false);
    request.responseType = 'arraybuffer';
    request.send();
    if (request.status !== 200) throw new Error(`${file}: the server answers ${request.status}; it may hold a newer page than this one`);
    return new WebAssembly.Module(withMemory(new Uint8Array(request.response as ArrayBuffer), this.shared));
  }
}
