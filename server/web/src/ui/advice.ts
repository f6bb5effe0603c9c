import type { Remedy } from "../service/types.ts";
import { h } from "./dom.ts";

/** Options that the service proposes, each with a button that sets them. */
export function adviceList(remedies: readonly Remedy[], onApply: (options: string) => void): HTMLElement {
  return h(
    "ul",
    { class: "advice", "aria-label": "Advice" },
    ...remedies.map(({ options, effect }) =>
      h(
        "li",
        {},
        h(
          "button",
          { type: "button", "data-options": options, click: () => onApply(options) },
          `Set ${wordsOf(options)}`,
        ),
        h("span", { class: "muted" }, ` ${effect}`),
      ),
    ),
  );
}

/** `a=1&b=2` as "a = 1, b = 2", with spaces in place of underscores in names. */
export function wordsOf(options: string): string {
  return [...pairsOf(options)].map(([name, value]) => `${name.replaceAll("_", " ")} = ${value}`).join(", ");
}

/** A plus is a plus here: `repair=+holes`. */
export function pairsOf(options: string): [string, string][] {
  return options
    .split("&")
    .filter((part) => part !== "")
    .map((part) => {
      const at = part.indexOf("=");
      return [part.slice(0, at), decodeURIComponent(part.slice(at + 1))];
    });
}
