// A colour for each surface: the hue tells the kind, and each surface of the kind has a tone of its own.
import type { RecognisedSurface, SurfaceKind } from "../service/types.ts";
import { type SurfaceGroup, kKinds } from "./groups.ts";

/** Red, green, blue, from 0 to 255. */
export type Rgb = [number, number, number];

interface Tones {
  /** Degrees: the middle of the kind's hues, and how far the others are from it. */
  hue: number;
  spread: number;
  saturation: number;
  /** The darkest and the lightest tone. */
  lightness: [number, number];
}

/**
 * No hue is near the yellow of what is chosen, the purple stripes of kept patches or the red of open edges. Planes are
 * grey, because most of a part is planes and they are what one asks for least.
 */
const kTones: Record<SurfaceKind, Tones> = {
  plane: { hue: 210, spread: 20, saturation: 0.1, lightness: [0.74, 0.86] },
  cylinder: { hue: 211, spread: 14, saturation: 0.62, lightness: [0.5, 0.7] },
  cone: { hue: 21, spread: 9, saturation: 0.8, lightness: [0.52, 0.7] },
  sphere: { hue: 140, spread: 18, saturation: 0.42, lightness: [0.42, 0.64] },
  torus: { hue: 262, spread: 12, saturation: 0.52, lightness: [0.6, 0.76] },
  revolution: { hue: 176, spread: 8, saturation: 0.55, lightness: [0.38, 0.6] },
  free: { hue: 2, spread: 10, saturation: 0.34, lightness: [0.56, 0.7] },
};
/** The colour of a kind, for a legend. */
export function colourOfKind(kind: SurfaceKind): Rgb {
  return toneOf(kind, 0.5, 0.5);
}

/** Steps of the golden ratio: numbers that follow each other are far apart. */
const golden = (n: number): number => (n * 0.61803398875) % 1;

function toneOf(kind: SurfaceKind, hue: number, lightness: number): Rgb {
  const tones = kTones[kind];
  const [low, high] = tones.lightness;
  return rgbOf(tones.hue + (2 * hue - 1) * tones.spread, tones.saturation, low + (high - low) * lightness);
}

function rgbOf(hue: number, saturation: number, lightness: number): Rgb {
  const strength = saturation * Math.min(lightness, 1 - lightness);
  const channel = (n: number): number => {
    const k = (n + hue / 30 + 12) % 12;
    return Math.round(255 * (lightness - strength * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}

/** Three bytes for each surface, by its id. There may be a million of them, so that they are one array. */
export type SurfaceColours = Uint8Array;

/** Output: the colours of all surfaces in the groups. Equal surfaces have one hue. */
export function coloursOf(groups: readonly SurfaceGroup[]): SurfaceColours {
  const count = groups.reduce((sum, { surfaces }) => sum + surfaces.length, 0);
  const colours = new Uint8Array(3 * count);
  for (const kind of kKinds) {
    let n = 0;
    groups
      .filter((group) => group.kind === kind)
      .forEach(({ surfaces }, i) => {
        for (const { id } of surfaces) colours.set(toneOf(kind, golden(i + 0.8), golden(++n)), 3 * id);
      });
  }
  return colours;
}
export function colourOf(colours: SurfaceColours, { id }: RecognisedSurface): Rgb {
  return [colours[3 * id]!, colours[3 * id + 1]!, colours[3 * id + 2]!];
}

/** The colour of a number, as the shader has it for patches and labels. */
export function categoryColour(id: number): Rgb {
  const hue = (id * 0.61803398875 + 0.08) % 1;
  const tone = (id * 0.38196601125) % 1;
  return [0, 4, 2].map((shift) => {
    const strength = Math.min(Math.max(Math.abs(((hue * 6 + shift) % 6) - 3) - 1, 0), 1);
    return Math.round(255 * ((0.74 + 0.14 * tone + 0.42 + 0.56 * strength) / 2));
  }) as Rgb;
}

export function cssOf([red, green, blue]: Rgb): string {
  return `rgb(${red} ${green} ${blue})`;
}

/**
 * What the views need to know of each patch: four bytes, the colour of its surface and whether that one is chosen.
 * `surfaceOf`: the id of the surface of each patch.
 */
export function patchTable(
  surfaceOf: Uint32Array,
  colours: SurfaceColours,
  chosen: ReadonlySet<RecognisedSurface["id"]>,
): Uint8Array {
  const table = new Uint8Array(4 * surfaceOf.length);
  for (let patch = 0; patch < surfaceOf.length; ++patch) {
    const surface = surfaceOf[patch]!;
    for (let k = 0; k < 3; ++k) table[4 * patch + k] = colours[3 * surface + k]!;
    table[4 * patch + 3] = chosen.has(surface) ? 255 : 0;
  }
  return table;
}
