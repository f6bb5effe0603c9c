// Numbers and names as people read them.

const kWhole = new Intl.NumberFormat("en");
const kReal = new Intl.NumberFormat("en", { maximumSignificantDigits: 5 });
const kTiny = new Intl.NumberFormat("en", { maximumSignificantDigits: 3, notation: "scientific" });

export function whole(value: number): string {
  return kWhole.format(value);
}
export function real(value: number): string {
  if (!Number.isFinite(value)) return "∞";
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-4 || size >= 1e9) ? kTiny.format(value).replace("E", "e") : kReal.format(value);
}
export function degrees(value: number): string {
  return `${value.toFixed(value !== 0 && value < 0.1 ? 3 : 1)}°`;
}
export function seconds(ms: number): string {
  return ms < 1000 ? `${ms < 10 ? ms.toFixed(1) : ms.toFixed(0)} ms` : `${(ms / 1000).toFixed(1)} s`;
}
export function count(n: number, one: string, many = `${one}s`): string {
  return `${whole(n)} ${n === 1 ? one : many}`;
}

export function sentence(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** `max_edge_length` as "Max edge length", `min_angle_deg` as "Min angle (°)". */
export function label(name: string): string {
  const words = name.replace(/_deg$/, " (°)").replaceAll("_", " ");
  return sentence(words);
}
