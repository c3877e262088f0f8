// A gamepad drives what arrow keys drive; its buttons press the demo's other inputs in their order.
import type {Input} from './protocol';

const STICK: Record<string, [axis: number, sign: number, button: number]> = {
  ArrowUp: [1, -1, 12], ArrowDown: [1, 1, 13], ArrowLeft: [0, -1, 14], ArrowRight: [0, 1, 15],
};
const DEAD = 0.15;

export class Gamepads {
  private held = new Map<string, number>();
  inputs: Input[] = [];

  constructor(private send: (message: object) => void) {}

  /** Once a frame: gamepads have no events of their own. */
  poll(): void {
    const pad = navigator.getGamepads?.().find((p) => p?.connected);
    if (!pad) return;
    let button = 0;
    const wanted = new Map<string, number>();
    for (const input of this.inputs) {
      const stick = input.keys.map((key) => STICK[key]).find((s) => s);
      let value: number;
      if (stick) {
        const lean = stick[1] * (pad.axes[stick[0]] ?? 0);
        value = Math.max(lean > DEAD ? (lean - DEAD) / (1 - DEAD) : 0, pad.buttons[stick[2]]?.value ?? 0);
      } else value = pad.buttons[button++]?.value ?? 0;
      const sent = Math.round(50 * Math.min(1, value)) / 50 * input.value;
      if (sent !== 0 || !wanted.has(input.action)) wanted.set(input.action, sent);
    }
    for (const [action, value] of wanted) {
      if ((this.held.get(action) ?? 0) === value) continue;
      this.held.set(action, value);
      this.send({type: 'input', action, value});
    }
  }
}
