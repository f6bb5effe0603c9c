// Colours that need a number of each triangle: sizes, distances, labels. The arrays are made when they are asked for.
import type { Deviation } from "./mesh/deviation.ts";
import { type Drawable, kValue } from "./mesh/drawable.ts";
import type { FaceLabels, LabelKind } from "./mesh/face_labels.ts";
import type { LegendText } from "./ui/legend.ts";
import { real } from "./ui/words.ts";
import { type Side, type Viewer, kSides } from "./view/viewer.ts";

export type Numbered = "size" | "distance" | LabelKind;

export class NumberedColours {
  private deviation: Deviation | null = null;
  private labels: FaceLabels[] = [];

  constructor(private readonly viewer: Viewer) {}

  /** What is known of the meshes on the screen. */
  set told(labels: FaceLabels[]) {
    this.labels = labels;
    this.deviation = null;
  }
  set measured(deviation: Deviation) {
    this.deviation = deviation;
  }
  /** Those colourings of which something is known. */
  get known(): Numbered[] {
    return ["size", ...(this.deviation ? (["distance"] as const) : []), ...this.labels.map(({ kind }) => kind)];
  }

  /** Gives the views the numbers. Output: what they mean, or null where nothing is known. */
  use(colouring: Numbered): LegendText | null {
    if (colouring === "size") return this.useSizes();
    if (colouring === "distance") return this.useDistances();
    return this.useLabels(colouring);
  }

  private useSizes(): LegendText | null {
    const sizes = new Map<Side, Float32Array>();
    let [least, most] = [Infinity, 0];
    for (const side of kSides) {
      const drawable = this.viewer.drawable(side);
      if (!drawable) continue;
      const longest = longestEdges(drawable);
      for (const size of longest) if (size > 0) [least, most] = [Math.min(least, size), Math.max(most, size)];
      sizes.set(side, longest);
    }
    if (sizes.size === 0) return null;
    const span = Math.log(most / least) || 1;
    for (const [side, longest] of sizes)
      this.viewer.setNumbers(
        side,
        longest.map((size) => (size > 0 ? Math.log(size / least) / span : 0)),
      );
    const unit = this.radius;
    return { what: "Longest edge", ends: [real3(least * unit), real3(most * unit)], isReversed: false };
  }

  private useDistances(): LegendText | null {
    if (!this.deviation) return null;
    const { max } = this.deviation;
    for (const side of kSides)
      this.viewer.setNumbers(
        side,
        this.deviation[side].map((d) => (max > 0 ? 1 - d / max : 1)),
      );
    return { what: "Distance from the other surface", ends: ["0", real3(max * this.radius)], isReversed: true };
  }

  private useLabels(kind: LabelKind): LegendText | null {
    const label = this.labels.find((one) => one.kind === kind);
    const { before, after } = { before: this.viewer.drawable("before"), after: this.viewer.drawable("after") };
    if (!label || !after) return null;
    this.viewer.setNumbers(
      "after",
      Float32Array.from(after.face, (face) => label.after[face]!),
    );
    if (before)
      this.viewer.setNumbers(
        "before",
        Float32Array.from(before.face, (_, t) => label.ofPatch[before.values[kValue.count * t + kValue.patch]!] ?? -1),
      );
    return { what: kind, names: label.names };
  }

  private get radius(): number {
    return (this.viewer.drawable("before") ?? this.viewer.drawable("after"))?.frame.radius ?? 1;
  }
}

const real3 = (x: number): string => real(Number(x.toPrecision(3)));

function longestEdges({ positions }: Drawable): Float32Array {
  const longest = new Float32Array(positions.length / 9);
  for (let t = 0; t < longest.length; ++t) {
    for (let k = 0; k < 3; ++k) {
      const [p, q] = [9 * t + 3 * k, 9 * t + 3 * ((k + 1) % 3)];
      const length = Math.hypot(
        positions[p]! - positions[q]!,
        positions[p + 1]! - positions[q + 1]!,
        positions[p + 2]! - positions[q + 2]!,
      );
      if (length > longest[t]!) longest[t] = length;
    }
  }
  return longest;
}
