// The form of options, made from what the service says of itself: a new option of the daemon appears by itself.
import type { OptionSpec } from "../service/types.ts";
import { type Child, h } from "./dom.ts";
import { label, real, sentence } from "./words.ts";

/** Those that most runs need; the others fold away. */
const kFirst = [
  "preset",
  "elements_per_circle",
  "refine",
  "min_angle_deg",
  "target_faces",
  "max_edge_length",
  "proximity",
];
/** The page asks for what it needs, see the downloads. */
const kNotAsked = ["format"];
/** Numbers to pick from, beside any other. */
const kUsual: Record<string, number[]> = { elements_per_circle: [8, 12, 16, 24, 36] };
/** Choices that say more than their word. */
const kChoices: Record<string, string> = { volume: "for volume meshing" };
const kControls = "input, select";

interface Field {
  spec: OptionSpec;
  row: HTMLElement;
  note: HTMLElement;
  /** As the query takes it; null: the default. */
  value: () => string | null;
  /** In words, or null. */
  fault: () => string | null;
  reset: () => void;
  setEnabled: (isEnabled: boolean) => void;
}

export class OptionsForm {
  private readonly fields: Field[];

  constructor(
    container: HTMLElement,
    specs: OptionSpec[],
    private readonly onChange: () => void,
  ) {
    this.fields = specs.filter((spec) => !kNotAsked.includes(spec.name)).map((spec) => this.field(spec));
    const isFirst = (field: Field): boolean => kFirst.includes(field.spec.name);
    const others = this.fields.filter((field) => !isFirst(field));
    const groups = [...new Set(others.map((field) => field.spec.group))];
    const more = h(
      "details",
      { class: "more" },
      h("summary", {}, "More options"),
      ...groups.flatMap((group) => [
        h("h3", {}, sentence(group)),
        ...others.filter((field) => field.spec.group === group).map((field) => field.row),
      ]),
    );
    const first = kFirst.flatMap((name) => this.fields.filter((field) => field.spec.name === name));
    container.replaceChildren(...first.map((field) => field.row), more);
    this.changed();
  }

  /** What differs from the defaults, as query parameters. */
  values(): [string, string][] {
    return this.fields.flatMap((field) => {
      const value = field.value();
      return value === null ? [] : [[field.spec.name, value] as [string, string]];
    });
  }
  /** Shows what is wrong, and moves to the first of it. Output: whether nothing is. */
  check(): boolean {
    const first = this.fields.find((field) => field.fault() !== null);
    first?.row.closest("details")?.setAttribute("open", "");
    first?.row.querySelector<HTMLElement>(kControls)?.focus();
    return !first;
  }
  /** Points at the option that the service refused. */
  blame(name: string): void {
    const field = this.fields.find(({ spec }) => spec.name === name);
    field?.row.closest("details")?.setAttribute("open", "");
    field?.row.querySelector<HTMLElement>(kControls)?.focus();
  }
  reset(): void {
    for (const field of this.fields) field.reset();
    this.changed();
  }

  private changed(): void {
    for (const { spec, row, note, value, fault, setEnabled } of this.fields) {
      row.classList.toggle("changed", value() !== null);
      const rival = this.fields.find((other) => other.spec.name === spec.excludes && other.value() !== null);
      setEnabled(!rival);
      const wrong = fault();
      note.textContent = wrong ?? (rival ? `Excluded by ${label(rival.spec.name).toLowerCase()}.` : help(spec));
      note.classList.toggle("wrong", wrong !== null);
      row.querySelector(kControls)?.setAttribute("aria-invalid", String(wrong !== null));
    }
    this.onChange();
  }

  private field(spec: OptionSpec): Field {
    const id = `option-${spec.name}`;
    const note = h("p", { class: "note", id: `${id}-note` });
    if (spec.type === "boolean") return this.toggle(spec, id, note);
    if (spec.type === "string" && spec.values && spec.is_list) return this.words(spec, id, note, spec.values);
    if (spec.type === "string" && spec.values) {
      const standard = spec.unset ?? String(spec.default);
      return this.choice(spec, id, note, [standard, ...spec.values.filter((word) => word !== standard)]);
    }
    return this.text(spec, id, note);
  }

  private toggle(spec: OptionSpec, id: string, note: HTMLElement): Field {
    const input = h("input", {
      type: "checkbox",
      id,
      checked: spec.default === true,
      "aria-describedby": note.id,
      change: () => this.changed(),
    });
    const row = h(
      "div",
      { class: "option" },
      h("label", { for: id, class: "check" }, input, " ", label(spec.name)),
      note,
    );
    return {
      spec,
      row,
      note,
      value: () => (input.checked === (spec.default === true) ? null : String(input.checked)),
      fault: () => null,
      reset: () => (input.checked = spec.default === true),
      setEnabled: (isEnabled) => (input.disabled = !isEnabled),
    };
  }

  /** One word of several; the first is the default. */
  private choice(spec: OptionSpec, id: string, note: HTMLElement, words: string[]): Field {
    const select = h(
      "select",
      { id, "aria-describedby": note.id, change: () => this.changed() },
      ...words.map((word) => h("option", { value: word }, kChoices[word] ?? label(word).toLowerCase())),
    );
    const row = h(
      "div",
      { class: "option" },
      h("div", { class: "line" }, h("label", { for: id }, label(spec.name)), select),
      note,
    );
    return {
      spec,
      row,
      note,
      value: () => (select.value === words[0] ? null : select.value),
      fault: () => null,
      reset: () => (select.value = words[0]!),
      setEnabled: (isEnabled) => (select.disabled = !isEnabled),
    };
  }

  /** Some of a list of words. */
  private words(spec: OptionSpec, id: string, note: HTMLElement, words: string[]): Field {
    const defaults = String(spec.default).split(",");
    const inputs = words.map((word) =>
      h("input", { type: "checkbox", value: word, checked: defaults.includes(word), change: () => this.changed() }),
    );
    const row = h(
      "fieldset",
      { class: "option", id, "aria-describedby": note.id },
      h("legend", {}, label(spec.name)),
      h(
        "div",
        { class: "words" },
        ...inputs.map((input): Child => h("label", { class: "check" }, input, " ", label(input.value).toLowerCase())),
      ),
      note,
    );
    const chosen = (): string =>
      inputs
        .filter((input) => input.checked)
        .map((input) => input.value)
        .join(",");
    const initial = words.filter((word) => defaults.includes(word)).join(",");
    return {
      spec,
      row,
      note,
      value: () => (chosen() === initial ? null : chosen() || "none"),
      fault: () => null,
      reset: () => inputs.forEach((input) => (input.checked = defaults.includes(input.value))),
      setEnabled: (isEnabled) => inputs.forEach((input) => (input.disabled = !isEnabled)),
    };
  }

  /** A number, with a slider where it has two ends, or another text. */
  private text(spec: OptionSpec, id: string, note: HTMLElement): Field {
    const isNumber = spec.type !== "string";
    const usual = kUsual[spec.name];
    const list = usual && h("datalist", { id: `${id}-usual` }, ...usual.map((value) => h("option", { value })));
    const standard = spec.default === null ? (spec.unset ?? "") : String(spec.default);
    const input = h("input", {
      type: "text",
      id,
      placeholder: standard,
      list: list ? list.id : null,
      inputmode: isNumber ? "decimal" : "text",
      autocomplete: "off",
      spellcheck: "false",
      "aria-describedby": note.id,
    });
    const [low, high] = [spec.minimum, spec.maximum];
    // A slider is for ranges that the eye can divide, and begins at a number.
    const hasSlider = isNumber && spec.default !== null && low !== undefined && high !== undefined && high - low > 1;
    const slider = hasSlider
      ? h("input", {
          type: "range",
          min: low,
          max: high,
          step: (high - low) / 66,
          value: Number(spec.default),
          "aria-label": `${label(spec.name)}, slider`,
        })
      : null;
    input.addEventListener("input", () => {
      if (slider) slider.value = input.value === "" ? String(spec.default) : input.value;
      this.changed();
    });
    slider?.addEventListener("input", () => {
      input.value = Number(slider.value) === spec.default ? "" : slider.value;
      this.changed();
    });
    const row = h(
      "div",
      { class: "option" },
      h("div", { class: "line" }, h("label", { for: id }, label(spec.name)), slider, input, list),
      note,
    );
    const value = (): string | null => {
      const text = input.value.trim();
      return text === "" || text === standard ? null : text;
    };
    return {
      spec,
      row,
      note,
      value,
      fault: () => {
        const text = value();
        const isWord = text === spec.unset || (text !== null && spec.values?.includes(text));
        return text === null || !isNumber || isWord ? null : faultOfNumber(spec, text);
      },
      reset: () => {
        input.value = "";
        if (slider) slider.value = String(spec.default);
      },
      setEnabled: (isEnabled) => {
        input.disabled = !isEnabled;
        if (slider) slider.disabled = !isEnabled;
      },
    };
  }
}

/** "0 to 33", "above 0"; empty where anything goes. */
function range({ minimum, exclusive_minimum, maximum }: OptionSpec): string {
  if (minimum !== undefined && maximum !== undefined) return `${real(minimum)} to ${real(maximum)}`;
  return [
    minimum === undefined ? "" : `at least ${real(minimum)}`,
    exclusive_minimum === undefined ? "" : `above ${real(exclusive_minimum)}`,
    maximum === undefined ? "" : `at most ${real(maximum)}`,
  ]
    .filter(Boolean)
    .join(", ");
}

/** What an option does and takes. */
function help(spec: OptionSpec): string {
  const takes = range(spec);
  return `${sentence(spec.description)}${takes && ` (${takes})`}.`;
}

/** What is wrong with a number, in words; the service has the last word. */
export function faultOfNumber(spec: OptionSpec, text: string): string | null {
  const isWhole = /^[\d.]+(e[+-]?\d+)?$/i.test(text) && Number.isInteger(Number(text));
  const value = spec.type === "integer" && !isWhole ? NaN : Number(text);
  const isInside =
    Number.isFinite(value) &&
    !(value < (spec.minimum ?? -Infinity)) &&
    !(value <= (spec.exclusive_minimum ?? -Infinity)) &&
    !(value > (spec.maximum ?? Infinity));
  if (isInside) return null;
  const number = spec.type === "integer" ? "a whole number" : "a number";
  const words = [...(spec.values ?? []), ...(spec.unset ? [spec.unset] : [])];
  return `This takes ${number}, ${range(spec)}${words.length > 0 ? `; or ${words.join(" or ")}` : ""}.`;
}
