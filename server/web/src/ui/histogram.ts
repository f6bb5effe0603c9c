import type { Histogram } from "../service/types.ts";
import { h, svg } from "./dom.ts";
import { real, whole } from "./words.ts";

const kWidth = 460;
const kHeight = 168;
const kMargin = { left: 36, right: 14, top: 10, bottom: 34 };

export interface HistogramText {
  title: string;
  /** Below the axis. */
  axis: string;
  /** Of a value on the axis. */
  format: (value: number) => string;
  /** Drawn as a line, if it lies on the axis. */
  bound: number | null;
  /** In words, for the line. */
  boundName: string;
}

const share = (histogram: Histogram): number[] => {
  const sum = histogram.counts.reduce((total, n) => total + n, 0);
  return histogram.counts.map((n) => (sum > 0 ? n / sum : 0));
};

/** Two distributions over the same bins, as shares of each whole; with the numbers as a table for those who ask. */
export function histogramChart(before: Histogram, after: Histogram | null, text: HistogramText): HTMLElement {
  const shares = [share(before), after ? share(after) : []] as const;
  const used = before.counts.map((n, i) => n + (after?.counts[i] ?? 0));
  const last = Math.max(
    used.findLastIndex((n) => n > 0),
    3,
  );
  const bins = last + 1;
  const most = Math.max(...shares[0], ...shares[1]);
  const top = [0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1].find((value) => value >= most) ?? 1;
  const width = (kWidth - kMargin.left - kMargin.right) / bins;
  const height = kHeight - kMargin.top - kMargin.bottom;
  const x = (bin: number): number => kMargin.left + bin * width;
  const y = (part: number): number => kMargin.top + height * (1 - part / top);

  const chart = svg("svg", { viewBox: `0 0 ${kWidth} ${kHeight}`, role: "img", "aria-label": `${text.title}: chart` });
  for (const part of [0, top / 2, top]) {
    chart.append(
      svg("line", { class: "grid", x1: kMargin.left, x2: kWidth - kMargin.right, y1: y(part), y2: y(part) }),
      svg(
        "text",
        { class: "tick", x: kMargin.left - 5, y: y(part) + 3.5, "text-anchor": "end" },
        `${Math.round(part * 100)}%`,
      ),
    );
  }
  const bar = (name: string, bin: number, part: number, left: number, wide: number): void => {
    if (part <= 0) return;
    const tall = Math.max(height * (part / top), 1);
    chart.append(
      svg("rect", {
        class: name,
        x: x(bin) + left * width,
        y: kMargin.top + height - tall,
        width: wide * width,
        height: tall,
      }),
    );
  };
  for (let bin = 0; bin < bins; ++bin) {
    bar("bar-before", bin, shares[0][bin]!, 0.08, after ? 0.4 : 0.84);
    if (after) bar("bar-after", bin, shares[1][bin]!, 0.52, 0.4);
    const column = svg("rect", { class: "column", x: x(bin), y: kMargin.top, width, height });
    column.append(svg("title", {}, tip(before, after, bin, text)));
    chart.append(column);
  }
  const step = Math.ceil(bins / 9);
  for (let edge = 0; edge <= bins; edge += step) {
    chart.append(
      svg(
        "text",
        { class: "tick", x: x(edge), y: kHeight - 20, "text-anchor": "middle" },
        text.format(before.edges[edge]!),
      ),
    );
  }
  chart.append(
    svg("text", { class: "axis", x: (kMargin.left + kWidth) / 2, y: kHeight - 4, "text-anchor": "middle" }, text.axis),
  );
  drawBound(chart, before.edges.slice(0, bins + 1), x, text);

  return h(
    "figure",
    { class: "histogram" },
    h(
      "figcaption",
      {},
      h("h3", {}, text.title),
      h("span", { class: "key key-before" }, "before"),
      after && h("span", { class: "key key-after" }, "after"),
    ),
    chart,
    table(before, after, bins, text),
  );
}

function tip(before: Histogram, after: Histogram | null, bin: number, text: HistogramText): string {
  const range = `${text.format(before.edges[bin]!)} – ${text.format(before.edges[bin + 1]!)}`;
  return `${range}: ${whole(before.counts[bin]!)} before` + (after ? `, ${whole(after.counts[bin]!)} after` : "");
}

function drawBound(
  chart: SVGElement,
  edges: number[],
  x: (bin: number) => number,
  { bound, boundName }: HistogramText,
): void {
  if (bound === null) return;
  const bin = edges.findLastIndex((edge) => edge <= bound);
  if (bin < 0 || bin >= edges.length - 1) return;
  const at = x(bin + (bound - edges[bin]!) / (edges[bin + 1]! - edges[bin]!));
  const isRight = at > kWidth * 0.7;
  chart.append(
    svg("line", { class: "bound", x1: at, x2: at, y1: kMargin.top - 6, y2: kHeight - kMargin.bottom }),
    svg(
      "text",
      { class: "bound-name", x: at + (isRight ? -5 : 5), y: kMargin.top + 3, "text-anchor": isRight ? "end" : "start" },
      boundName,
    ),
  );
}

function table(before: Histogram, after: Histogram | null, bins: number, text: HistogramText): HTMLElement {
  const rows = Array.from({ length: bins }, (_, bin) =>
    h(
      "tr",
      {},
      h("th", { scope: "row" }, `${real(before.edges[bin]!)} – ${real(before.edges[bin + 1]!)}`),
      h("td", {}, whole(before.counts[bin]!)),
      after && h("td", {}, whole(after.counts[bin]!)),
    ),
  );
  return h(
    "details",
    { class: "as-table" },
    h("summary", {}, "As a table"),
    h(
      "table",
      {},
      h(
        "thead",
        {},
        h(
          "tr",
          {},
          h("th", { scope: "col" }, text.axis),
          h("th", { scope: "col" }, "before"),
          after && h("th", { scope: "col" }, "after"),
        ),
      ),
      h("tbody", {}, ...rows),
    ),
  );
}
