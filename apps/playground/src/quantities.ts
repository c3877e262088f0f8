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
/** Labels of ticks `increment` apart: as many digits as the step needs, the same power of ten for all. */
export function tickLabels(ticks: number[], increment: number): string[] {
  const largest = Math.max(...ticks.map(Math.abs), increment);
  const exponent = Math.floor(Math.log10(largest));
  // 2.5 needs one digit more than 2; what comes after the seventh is rounding of the tick itself.
  const power = Math.floor(Math.log10(increment) + 1e-9), place = power - (increment / 10 ** power % 1 > 1e-6 ? 1 : 0);
  if (exponent >= 6 || exponent < -3) {
    const digits = Math.max(0, Math.min(9, exponent - place));
    return ticks.map((t) => t === 0 ? '0' : `${(t / 10 ** exponent).toFixed(digits)}·10${superscript(exponent)}`);
  }
  return ticks.map((t) => (Math.abs(t) < increment / 1e6 ? 0 : t).toFixed(Math.max(0, Math.min(12, -place))));
}
const superscript = (n: number) => String(n).split('').map((c) => ({'-': '⁻', '0': '⁰', '1': '¹', '2': '²', '3': '³', '4': '⁴', '5': '⁵', '6': '⁶', '7': '⁷', '8': '⁸', '9': '⁹'})[c] ?? '').join('');
