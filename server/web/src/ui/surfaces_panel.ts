// The surfaces of a mesh as a table: equal ones in one row, and beside it what is known of the chosen one.
import type { RecognisedSurface } from "../service/types.ts";
import { type SurfaceColours, colourOf } from "../surfaces/colours.ts";
import { sideOf, sweepOf } from "../surfaces/facts.ts";
import { type SurfaceGroup, extentOf, kindName, nameOfGroup, summaryOf } from "../surfaces/groups.ts";
import { type Child, h } from "./dom.ts";
import { nameOfSurface, surfaceFacts } from "./surface_card.ts";
import { kMaxStripes, swatch } from "./swatch.ts";
import { count, real, sentence, whole } from "./words.ts";

/** More rows or buttons than these are of no use to a reader. */
const kMaxRows = 200;
const kMaxMembers = 100;

export interface ShownSurfaces {
  groups: SurfaceGroup[];
  colours: SurfaceColours;
  /** Whether it is known which faces belong to which surface. */
  areDrawn: boolean;
}

export class SurfacesPanel {
  private readonly list = h("div", { class: "surface-list" });
  private readonly details = h("div", { class: "surface-details" });
  private rows: { group: SurfaceGroup; row: HTMLElement; button: HTMLElement }[] = [];
  private shown: ShownSurfaces | null = null;
  private chosen: ReadonlySet<number> = new Set();

  /** `onChoose` is told the ids of what was clicked, or none where it was given up. */
  constructor(
    private readonly panel: HTMLElement,
    private readonly onChoose: (ids: number[]) => void,
  ) {}

  show(shown: ShownSurfaces): void {
    this.shown = shown;
    const { groups } = shown;
    this.rows = groups.slice(0, kMaxRows).map((group) => this.row(group));
    const left = groups.length - this.rows.length;
    const titles = ["Surfaces", "Side", "Sweep", "Faces", "Area"].map((name) => h("th", { scope: "col" }, name));
    this.list.replaceChildren(
      h("p", { class: "surface-summary" }, `${summaryOf(groups)}.`),
      h(
        "table",
        { class: "numbers-table" },
        h("thead", {}, h("tr", {}, ...titles)),
        h("tbody", {}, ...this.rows.map(({ row }) => row)),
      ),
      h("p", { class: "muted", hidden: left <= 0 }, `${count(left, "more row is", "more rows are")} in the report.`),
    );
    this.panel.replaceChildren(h("div", { class: "surfaces" }, this.list, this.details));
    this.mark(new Set());
  }

  /** Shows which surfaces are chosen. */
  mark(chosen: ReadonlySet<number>): void {
    this.chosen = chosen;
    if (!this.shown) return;
    const isIn = ({ id }: RecognisedSurface): boolean => chosen.has(id);
    for (const { group, row, button } of this.rows) {
      const isPressed = group.surfaces.some(isIn);
      button.setAttribute("aria-pressed", String(isPressed));
      row.classList.toggle("chosen", isPressed);
    }
    const at = this.shown.groups.findIndex((group) => group.surfaces.some(isIn));
    const group = this.shown.groups[at];
    const parts = group
      ? this.detailsOf(group, group.surfaces.filter(isIn))
      : [h("p", { class: "muted" }, this.advice())];
    const hadFocus = this.details.contains(document.activeElement);
    this.details.replaceChildren(...parts.filter((part) => part instanceof Node));
    this.details.scrollTop = 0;
    if (hadFocus) (this.details.querySelector<HTMLElement>("[aria-pressed=true]") ?? this.panel).focus();
    if (group) this.reveal(this.rows[at]?.row);
  }

  /** Scrolls the list, and nothing around it. */
  private reveal(row: HTMLElement | undefined): void {
    if (!row) return;
    const [inner, outer] = [row.getBoundingClientRect(), this.list.getBoundingClientRect()];
    if (inner.top < outer.top) this.list.scrollTop += inner.top - outer.top;
    else if (inner.bottom > outer.bottom) this.list.scrollTop += inner.bottom - outer.bottom;
  }

  private advice(): string {
    return this.shown?.areDrawn
      ? "Click a row to see its faces in the views, or colour the views by surface and click a face."
      : "Click a row to see its numbers. Remesh the mesh to see its surfaces in the views: an analysis does not tell which face belongs to which surface.";
  }

  private row(group: SurfaceGroup): (typeof this.rows)[number] {
    const { surfaces } = group;
    const sum = (of: (surface: RecognisedSurface) => number): number => surfaces.reduce((s, x) => s + of(x), 0);
    const button = h(
      "button",
      { type: "button", class: "surface-name", "aria-pressed": "false" },
      this.swatchOf(surfaces),
      nameOfGroup(group),
    );
    const row = h(
      "tr",
      { "data-kind": group.kind, click: () => this.toggle(group) },
      h("th", { scope: "row" }, button),
      h("td", {}, tally(surfaces.map(sideOf))),
      h("td", {}, tally(surfaces.map(sweepOf))),
      h("td", {}, whole(sum(({ faces }) => faces))),
      h("td", {}, real(sum(({ area }) => area))),
    );
    return { group, row, button };
  }

  private swatchOf(surfaces: RecognisedSurface[]): SVGElement {
    return swatch(surfaces.slice(0, kMaxStripes).map((surface) => colourOf(this.shown!.colours, surface)));
  }

  private toggle({ surfaces }: SurfaceGroup): void {
    const areAll = surfaces.every(({ id }) => this.chosen.has(id));
    this.onChoose(areAll ? [] : surfaces.map(({ id }) => id));
  }

  private detailsOf(group: SurfaceGroup, chosen: RecognisedSurface[]): Child[] {
    const only = chosen.length === 1 ? chosen[0]! : null;
    const title = only ? nameOfSurface(only) : sentence(nameOfGroup(group));
    return [
      h("h3", {}, this.swatchOf(chosen), title),
      h("p", {}, h("button", { type: "button", class: "quiet let-go", click: () => this.onChoose([]) }, "Choose none")),
      group.surfaces.length > 1 && this.members(group, only),
      only && surfaceFacts(only),
    ];
  }

  /** The surfaces of a group, to choose one of them. */
  private members({ kind, surfaces }: SurfaceGroup, only: RecognisedSurface | null): HTMLElement {
    const choice = (text: string, isPressed: boolean, chosen: RecognisedSurface[]): HTMLElement =>
      h(
        "button",
        {
          type: "button",
          "aria-pressed": String(isPressed),
          click: () => this.onChoose(chosen.map(({ id }) => id)),
        },
        text,
      );
    const listed = surfaces.slice(0, kMaxMembers);
    const buttons = [
      choice("All", only === null, surfaces),
      ...listed.map((surface) => choice(placeOf(surface), surface === only, [surface])),
    ];
    const many = kindName(kind, 2);
    const which = listed.length < surfaces.length ? `The ${listed.length} largest of these ${many}` : `These ${many}`;
    return h(
      "div",
      {},
      h("p", { class: "muted" }, `${which}, by their middles:`),
      h("ul", { "aria-label": sentence(many) }, ...buttons.map((item) => h("li", {}, item))),
    );
  }
}

/** "full turn", or "5 full turn, 3 180.0°" where they differ. */
function tally(words: string[]): string {
  const counts = new Map<string, number>();
  for (const word of words) counts.set(word, (counts.get(word) ?? 0) + 1);
  if (counts.size <= 1) return words[0] ?? "";
  if (counts.size > 2) return "various";
  return [...counts].map(([word, n]) => `${n} ${word}`).join(", ");
}

/** The middle of a surface's faces. */
function placeOf(surface: RecognisedSurface): string {
  const box = surface.bounding_box;
  if (!box) return `Surface ${whole(surface.id)}`;
  const extent = Math.hypot(...extentOf(surface));
  return box.min
    .map((x, i) => (x + box.max[i]!) / 2)
    .map((x) => real(Math.abs(x) < 1e-6 * extent ? 0 : Number(x.toPrecision(4))))
    .join(", ");
}
