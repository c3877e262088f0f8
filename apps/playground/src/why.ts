// The report on one body: why it is awake, what pushes it, and what the adviser says of it.
import {byId, element} from './dom';
import type {Inspected} from './protocol';
import {short} from './quantities';

const list = (items: string[]) => element('ul', {}, ...items.map((text) => element('li', {textContent: text})));
const size = (v: number[]) => Math.hypot(...v);

export function showReport(report: Inspected, dt: number): void {
  const host = byId('why');
  byId('why-section').hidden = report.body < 0;
  if (report.body < 0) return;
  const at = (v: number[]) => v.map((x) => short(x, 4)).join(', ');
  const row = (name: string, value: string) => [element('dt', {textContent: name}), element('dd', {textContent: value})];
  const open = new Set([...host.querySelectorAll('details[open]')].map((d) => d.id));
  const part = (id: string, title: string, body: Node) => element('details', {id, open: open.has(id)}, element('summary', {textContent: title}), body);
  const force = report.contacts.reduce((sum, c) => sum + c.impulse, 0) / dt;
  host.replaceChildren(
    element('p', {className: 'summary'}, element('strong', {textContent: report.name || `Body ${report.body}`}), ` (${report.kind}) is ${report.why}.`),
    ...report.advice.map((text) => element('p', {className: 'warning', textContent: text})),
    element('dl', {className: 'numbers'},
      ...row('Mass', `${short(report.mass)} kg`), ...row('Weight', `${short(report.weight)} N`), ...row('Centre of mass', `${at(report.position)} m`),
      ...row('Speed', `${short(size(report.velocity))} m/s`), ...row('Spin', `${short(size(report.angular_velocity))} rad/s`),
      ...row('Pushed by contacts', `${short(force)} N`)),
    part('why-contacts', `Contacts: ${report.contacts.length}`, list(report.contacts.map((c) =>
      `${c.with}: ${short(c.impulse)} N·s (${short(c.impulse / dt)} N) at ${c.points} point${c.points === 1 ? '' : 's'}, friction ${short(c.friction)} N·s, ${c.depth > 0 ? `${short(1000 * c.depth, 3)} mm deep` : 'not overlapping'}, colour ${c.color}`))),
    part('why-joints', `Joints: ${report.joints.length}`, list(report.joints.map((j) =>
      `${j.type} to ${j.with}: ${short(j.force)} N, ${short(j.torque)} N·m, ${short(1000 * j.error, 3)} mm apart, solved ${j.direct ? 'directly' : 'by iteration'}`))));
}
