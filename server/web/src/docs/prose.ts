import { type Child, h } from "../ui/dom.ts";

/** `code` between back quotes. */
function inline(text: string): Child[] {
  return text.split("`").map((part, i) => (i % 2 === 1 ? h("code", {}, part) : part));
}

/** A description: paragraphs with an empty line between, and lists whose items begin with "- ". */
export function prose(text = ""): HTMLElement[] {
  return text
    .trim()
    .split(/\n\s*\n/)
    .filter((block) => block !== "")
    .flatMap((block) => {
      const [lead, ...items] = block.split(/^- /m);
      return [
        ...(lead!.trim() === "" ? [] : [h("p", {}, ...inline(lead!.trim()))]),
        ...(items.length === 0 ? [] : [h("ul", {}, ...items.map((item) => h("li", {}, ...inline(item.trim()))))]),
      ];
    });
}
