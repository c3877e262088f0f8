// The one byte by which a module for several threads differs from one for a single thread: whether the memory that it
// imports is shared. Everything else (atomic instructions, data that the first instance lays out) is valid with both,
// so one module serves a page that may share memory and one that may not.

/** Pages of 64 KiB that the module asks for at least and at most (apps/wasm/CMakeLists.txt). */
export const PAGES = {initial: 256, maximum: 65536};

/**
 * A copy of a module that imports a memory, shared or not, as asked for.
 * @param {Uint8Array} module
 * @param {boolean} shared
 * @returns {Uint8Array<ArrayBuffer>}
 */
export function withMemory(module, shared) {
  const bytes = new Uint8Array(module);
  let at = 8;
  const number = () => { let value = 0, scale = 1, byte; do { byte = bytes[at++]; value += (byte & 127) * scale; scale *= 128; } while (byte & 128); return value; };
  const skip = () => { const size = number(); at += size; };
  const limits = () => { const flags = bytes[at++]; number(); if (flags & 1) number(); };
  while (at < bytes.length) {
    const section = bytes[at++];
    if (section !== 2) { skip(); continue; }  // 2: imports
    number();
    for (let left = number(); left > 0; --left) {
      skip();
      skip();
      const kind = bytes[at++];
      if (kind === 0) number();
      else if (kind === 1) { ++at; limits(); }
      else if (kind === 2) {
        bytes[at] = shared ? bytes[at] | 2 : bytes[at] & ~2;
        limits();
      } else if (kind === 3) at += 2;
      else throw new Error(`a module's import of kind ${kind} is not known; expected a function, table, memory or global`);
    }
    break;
  }
  return bytes;
}
