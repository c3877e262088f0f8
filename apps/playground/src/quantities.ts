// Numbers as people read them: display units, and as many digits as carry meaning.
import type {Parameter} from './protocol';

export const toDisplay = (p: Parameter, si: number) => si * p.display_factor + p.display_offset;
export const fromDisplay = (p: Parameter, shown: number) => (shown - p.display_offset) / p.display_factor;
export const unitOf = (p: Parameter) => (p.display_unit || p.unit || '').replace('*', '·').replace('deg', '°').replace(/\^2/g, '²').replace(/\^3/g, '³');

/** At most `digits` significant digits, without trailing zeros, never "-0". */
export function short(value: number, digits = 4): string {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const magnitude = Math.abs(value);
  if (magnitude >= 1e6 || magnitude < 1e-3) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${Number(mantissa)}·10${superscript(Number(exponent))}`;
  }
  return String(Number(value.toPrecision(digits)));
}
const superscript = (n: number) => String(n).split('').map((c) => ({'-': '⁻', '0': '⁰', '1': '¹', '2': '²', '3': '³', '4': '⁴', '5': '⁵', '6': '⁶', '7': '⁷', '8': '⁸', '9': '⁹'})[c] ?? '').join('');
