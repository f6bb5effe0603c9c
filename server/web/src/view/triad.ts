import { svg } from "../ui/dom.ts";
import { type Orbit, right, front, up } from "./orbit.ts";

const kNames = ["x", "y", "z"];
const kCentre = 32;
const kLength = 20;

/** The directions of the axes, in a corner of a view. */
export class Triad {
  readonly element = svg("svg", { class: "triad", viewBox: "0 0 64 64", "aria-hidden": "true" });
  private readonly axes = kNames.map((name) => {
    const line = svg("line", { x1: kCentre, y1: kCentre });
    const text = svg("text", { "text-anchor": "middle" }, name);
    const axis = svg("g", { class: `axis-${name}` }, line, text);
    return { line, text, axis };
  });

  constructor() {
    this.element.append(...this.axes.map(({ axis }) => axis));
  }

  turn(orbit: Orbit): void {
    const [across, above, towards] = [right(orbit), up(orbit), front(orbit)];
    const depths = this.axes.map((_, i) => towards.getComponent(i));
    this.axes.forEach(({ line, text }, i) => {
      const [x, y] = [across.getComponent(i), -above.getComponent(i)];
      line.setAttribute("x2", String(kCentre + kLength * x));
      line.setAttribute("y2", String(kCentre + kLength * y));
      text.setAttribute("x", String(kCentre + (kLength + 7) * x));
      text.setAttribute("y", String(kCentre + (kLength + 7) * y + 3.5));
    });
    // The nearest one last, over the others.
    const order = [0, 1, 2].sort((i, j) => depths[i]! - depths[j]!);
    this.element.append(...order.map((i) => this.axes[i]!.axis));
  }
}
