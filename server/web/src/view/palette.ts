// The views' colours, for a light page and a dark one. All in one place; style.css has those of the page.

export interface Palette {
  background: string;
  plain: string;
  inside: string;
  line: string;
  feature: string;
  open: string;
  selected: string;
  kept: string;
  mark: string;
  markRim: string;
  section: string;
  /** Edges of the input over the result. */
  overlay: string;
  /** From bad to good; told apart by lightness as well as by hue. */
  scale: string[];
}

const kScale = ["#b5312f", "#e8894a", "#f2d58b", "#9cc7b4", "#3a86a8"];

export const kLightPalette: Palette = {
  background: "#eceff2",
  plain: "#c3cdd6",
  inside: "#8d7f72",
  line: "#1c2730",
  feature: "#0b1117",
  open: "#c4161c",
  selected: "#ffd23f",
  kept: "#8e44ad",
  mark: "#d81b60",
  markRim: "#ffffff",
  section: "#0b6b8a",
  overlay: "#d2410c",
  scale: kScale,
};

export const kDarkPalette: Palette = {
  ...kLightPalette,
  background: "#0f1317",
  plain: "#93a0ac",
  inside: "#5d534b",
  line: "#05080a",
  feature: "#000000",
  open: "#ff6b5e",
  mark: "#ff4f8b",
  markRim: "#11161a",
  section: "#58b7d6",
  overlay: "#ffb347",
};
