// Sentences (descriptions of demos, formulas, messages) are an eighth of what a page downloads first, and most belong to
// a demo that is not open. What only one part of the module refers to is left out of the first file and lies in that part.

/** A number as WebAssembly writes it; `signed`: with room for a sign. */
export function leb(value, signed = false) {
  const out = [];
  for (;;) {
    const low = value & 127;
    value = Math.floor(value / 128);
    if (value === 0 && !(signed && low & 64)) { out.push(low); return Buffer.from(out); }
    out.push(low | 128);
  }
}

/** Where in memory the module's largest segment of data goes, and where in the file it lies: it is laid out by `memory.init`. */
function segmentOf(bytes, functions) {
  let at = 8, best;
  const number = () => { let value = 0, scale = 1, byte; do { byte = bytes[at++]; value += (byte & 127) * scale; scale *= 128; } while (byte & 128); return value; };
  while (at < bytes.length) {
    const section = bytes[at++], size = number(), end = at + size;
    if (section === 11) for (let n = number(), index = 0; index < n; ++index) {
      if (number() !== 1) throw new Error('a segment of data that is not passive');
      const length = number();
      if (length > (best?.length ?? 0)) best = {index, start: at, length};
      at += length;
    }
    at = end;
  }
  const length = Buffer.concat([Buffer.from([0x41, 0, 0x41]), leb(best.length, true), Buffer.from([0xfc, 8, best.index, 0])]);  // …, const 0, const length, memory.init
  for (const {code} of functions) {
    const found = Buffer.from(code.buffer, code.byteOffset, code.length).indexOf(length);
    for (let from = found - 6; found > 0 && from < found; ++from) {
      if (code[from] !== 0x41) continue;
      let value = 0, k = from + 1;
      for (let shift = 0; ; ++k, shift += 7) { value += (code[k] & 127) * 2 ** shift; if (!(code[k] & 128)) break; }
      if (k + 1 === found) return {...best, address: value};
    }
  }
  return undefined;
}

/** Sentences in the data: [first, behind the last] with their closing zero, from the segment's beginning. */
function sentences(data) {
  const found = [];
  for (let at = 0; at < data.length;) {
    let end = at, spaces = 0;
    for (; data[end] >= 32 && data[end] !== 127 || data[end] === 10; ++end) spaces += Number(data[end] === 32);
    if (data[end] === 0 && end - at >= 20 && spaces > 1 && data[at - 1] === 0) found.push([at, end + 1]);
    at = end + 1;
  }
  return found;
}

/**
 * The module without the sentences that only one part refers to, and for every part the section of data that brings its own.
 * `partOf`: of each function, undefined for the first file. A reference is a constant or the offset of a load or store
 * anywhere within the sentence; what a word of the data points at stays where it is.
 */
export function moveTexts(bytes, functions, partOf) {
  const segment = segmentOf(bytes, functions);
  if (!segment) throw new Error('the module lays out no data that could be found');
  const {start, length, address} = segment, data = bytes.subarray(start, start + length), texts = sentences(data), places = new Int32Array(length).fill(-1);
  texts.forEach(([from, to], i) => places.fill(i, from, to));
  const users = texts.map(() => new Set());
  const at = (place) => (place >= address && place < address + length ? places[place - address] : -1);
  functions.forEach(({code}, f) => {
    for (let i = 1; i + 2 < code.length; ++i) {
      // Only addresses of three or four bytes: the stack lies below all data.
      if (!(code[i] & 128 && code[i + 1] & 128)) continue;
      const constant = code[i - 1] === 0x41 || code[i - 1] === 0x42;
      const offset = code[i - 1] <= 4 && (code[i - 2] >= 0x28 && code[i - 2] <= 0x3e || code[i - 3] === 0xfd || code[i - 3] === 0xfe);
      if (!constant && !offset) continue;
      const text = at((code[i] & 127) | (code[i + 1] & 127) << 7 | (code[i + 2] & 127) << 14 | (code[i + 2] & 128 ? (code[i + 3] & 127) << 21 : 0));
      if (text >= 0) users[text].add(partOf[f]);
    }
  });
  const view = new DataView(data.buffer, data.byteOffset, length);
  for (let i = (4 - address % 4) % 4; i + 4 <= length; i += 4) { const text = at(view.getUint32(i, true)); if (text >= 0) users[text].add(undefined); }
  const module = Buffer.from(bytes), moved = new Map();
  texts.forEach(([from, to], i) => {
    const [part] = users[i];
    if (users[i].size !== 1 || part === undefined) return;
    moved.set(part, [...(moved.get(part) ?? []), [from, to]]);
    module.fill(0, start + from, start + to);
  });
  const sections = new Map();
  for (const [part, list] of moved) {
    const body = Buffer.concat([leb(list.length), ...list.flatMap(([from, to]) => [Buffer.from([0, 0x41]), leb(address + from, true), Buffer.from([0x0b]), leb(to - from), data.subarray(from, to)])]);
    sections.set(part, Buffer.concat([Buffer.from([11]), leb(body.length), body]));
  }
  return {module, sections};
}
