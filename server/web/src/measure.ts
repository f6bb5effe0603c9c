// The distance between two places of a surface, which are clicked one after the other.
import type { Point } from "./mesh/drawable.ts";
import { byId } from "./ui/dom.ts";
import { real } from "./ui/words.ts";
import type { Side, Viewer } from "./view/viewer.ts";

const kAdvice = "Click two places of a view. Near a corner, the corner is taken.";

export class Measure {
  private from: { side: Side; at: Point } | null = null;
  private isOn = false;

  constructor(private readonly viewer: Viewer) {
    byId("measure").addEventListener("click", () => this.turn(!this.isOn));
  }

  get isMeasuring(): boolean {
    return this.isOn;
  }

  turn(isOn: boolean): void {
    this.isOn = isOn;
    byId("measure").setAttribute("aria-pressed", String(isOn));
    document.body.classList.toggle("measuring", isOn);
    this.clear();
  }

  /** Forgets what was measured, as when another surface is shown. */
  clear(): void {
    this.from = null;
    for (const side of ["before", "after"] as const) this.viewer.rule(side, null);
    this.say(this.isOn ? kAdvice : "");
  }

  pick(side: Side, triangle: number, x: number, y: number): void {
    const drawable = this.viewer.drawable(side);
    if (!drawable || triangle < 0) return;
    const at = this.viewer.pointAt(side, triangle, x, y).toArray();
    const { from } = this;
    if (!from || from.side !== side) {
      this.clear();
      this.from = { side, at };
      this.say("Click the second place.");
      return;
    }
    this.viewer.rule(side, Float32Array.from([...from.at, ...at]));
    const along = at.map((place, axis) => (place - from.at[axis]!) * drawable.frame.radius);
    const [dx, dy, dz] = along.map(short);
    this.say(`Distance ${short(Math.hypot(...along))} (x ${dx}, y ${dy}, z ${dz})`);
    this.from = null;
  }

  private say(text: string): void {
    byId("measured").textContent = text;
    byId("measured").hidden = text === "";
  }
}

/** Places are floats, so that no more digits are true. */
function short(x: number): string {
  return real(Number(x.toPrecision(5)));
}
