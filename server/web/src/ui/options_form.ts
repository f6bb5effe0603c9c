// The form of options, made from what the service says of itself: a new option of the daemon appears by itself.
import type { OptionSpec } from "../service/types.ts";
import { type Child, h } from "./dom.ts";
import { label, real, sentence, whole } from "./words.ts";

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
/** What cannot be given together, beside what the service says of one option. */
const kRivals: Record<string, readonly string[]> = {
  target_faces: ["max_edge_length", "max_edge_fraction"],
  target_edge_length: ["max_edge_length", "max_edge_fraction"],
  max_edge_length: ["target_faces", "target_edge_length"],
  max_edge_fraction: ["target_faces", "target_edge_length"],
};
/** The page asks for what it needs, see the downloads. */
const kNotAsked = ["format"];
/** Numbers to pick from, beside any other. */
const kUsual: Record<string, number[]> = { elements_per_circle: [8, 12, 16, 24, 36] };
/** Choices that say more than their word. */
const kChoices: Record<string, string> = { volume: "for volume meshing" };
/** Numbers whose slider goes by factors, from the first to the second. */
const kByFactors: Record<string, [number, number]> = { target_faces: [100, 1_000_000] };
const kControls = "input, select";

interface Field {
  spec: OptionSpec;
  row: HTMLElement;
  note: HTMLElement;
  /** As the query takes it; null: the default. */
  value: () => string | null;
  /** In words, or null. */
  fault: () => string | null;
  /** Null: the default. */
  set: (value: string | null) => void;
  /** Shows the value that is in force while none is given; null: the default. */
  hint?: (value: string | null) => void;
  setEnabled: (isEnabled: boolean) => void;
}
/** Values by the names of options. */
export type Values = ReadonlyMap<string, string>;

export class OptionsForm {
  private readonly fields: Field[];
  /** What the service said is in force with the options as they are. */
  private told: Values = new Map();
  /** Beside numbers of elements, the faces to expect. */
  private expected: Record<string, number> = {};

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
  get isValid(): boolean {
    return this.fields.every((field) => field.fault() === null);
  }
  /** Points at the option that the service refused. */
  blame(name: string): void {
    const field = this.fields.find(({ spec }) => spec.name === name);
    field?.row.closest("details")?.setAttribute("open", "");
    field?.row.querySelector<HTMLElement>(kControls)?.focus();
  }
  reset(): void {
    this.setAll([]);
  }
  /** These, and the defaults of all others. */
  setAll(values: readonly [string, string][]): void {
    for (const field of this.fields) field.set(null);
    this.apply(values);
  }
  /** Sets some, as advice has them, and gives up what they exclude. */
  apply(values: readonly [string, string][]): void {
    for (const [name, value] of values) {
      const field = this.fields.find(({ spec }) => spec.name === name);
      if (!field) continue;
      if (field.row.closest("details.more") && value !== null) field.row.closest("details")?.setAttribute("open", "");
      for (const rival of this.rivalsOf(field.spec)) rival.set(null);
      field.set(value);
    }
    this.changed();
  }
  /** `values`: what is in force; `expected`: faces for numbers of elements per circle. */
  tell(values: Values, expected: Record<string, number>, faces: number): void {
    this.told = values;
    this.expected = expected;
    this.fields.find(({ spec }) => spec.name === "target_faces")?.hint?.(String(faces));
    this.describe();
  }

  private rivalsOf({ name, excludes }: OptionSpec): Field[] {
    const names = [excludes, ...(kRivals[name] ?? [])];
    return this.fields.filter(({ spec }) => names.includes(spec.name));
  }

  private changed(): void {
    // What was told held for other options.
    this.told = new Map();
    this.describe();
    this.onChange();
  }

  private describe(): void {
    const preset = this.fields.find(({ spec }) => spec.name === "preset");
    const ofPreset = preset ? presetValues(preset.spec, preset.value()) : new Map<string, string>();
    for (const { spec, row, note, value, fault, setEnabled, hint } of this.fields) {
      row.classList.toggle("changed", value() !== null);
      const inForce = value() ?? ofPreset.get(spec.name) ?? this.told.get(spec.name) ?? null;
      const isOther = value() === null && inForce !== null && inForce !== String(spec.default);
      if (spec.name !== "target_faces") hint?.(isOther ? inForce : null);
      row.classList.toggle("set-otherwise", isOther);
      const rival = value() === null ? this.rivalsOf(spec).find((other) => other.value() !== null) : undefined;
      setEnabled(!rival);
      const wrong = fault();
      const from = ofPreset.has(spec.name) ? `, from the preset ${preset?.value()}` : "";
      const now = isOther ? `In force: ${inForce}${from}. ` : "";
      note.textContent =
        wrong ??
        (rival ? `Excluded by ${label(rival.spec.name).toLowerCase()}.` : now + help(spec) + this.outlook(spec));
      note.classList.toggle("wrong", wrong !== null);
      row.querySelector(kControls)?.setAttribute("aria-invalid", String(wrong !== null));
    }
  }

  /** The faces to expect, for numbers of elements per circle. */
  private outlook({ name }: OptionSpec): string {
    const numbers = Object.entries(this.expected);
    if (name !== "elements_per_circle" || numbers.length === 0) return "";
    return ` Faces to expect: ${numbers.map(([n, faces]) => `${whole(faces)} with ${n}`).join(", ")}.`;
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
      set: (value) => (input.checked = value === null ? spec.default === true : value === "true"),
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
      set: (value) => (select.value = value !== null && words.includes(value) ? value : words[0]!),
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
      set: (value) => {
        const chosen = new Set(wordsAfter(defaults, value));
        for (const input of inputs) input.checked = chosen.has(input.value);
      },
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
    const scale = isNumber ? scaleOf(spec) : null;
    const slider = scale
      ? h("input", {
          type: "range",
          min: 0,
          max: scale.steps,
          step: 1,
          "aria-label": `${label(spec.name)}, slider`,
        })
      : null;
    const follow = (text: string): void => {
      if (!slider || !scale) return;
      slider.value = String(scale.place(Number(text)));
      slider.setAttribute("aria-valuetext", text);
    };
    follow(standard);
    input.addEventListener("input", () => {
      follow(input.value === "" ? input.placeholder : input.value);
      this.changed();
    });
    slider?.addEventListener("input", () => {
      const value = scale!.value(Number(slider.value));
      input.value = value === spec.default ? "" : String(value);
      slider.setAttribute("aria-valuetext", String(value));
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
      set: (text) => {
        input.value = text ?? "";
        follow(text ?? input.placeholder);
      },
      hint: (text) => {
        const shown = text ?? standard;
        if (spec.name !== "target_faces") input.placeholder = shown;
        if (input.value === "") follow(shown);
      },
      setEnabled: (isEnabled) => {
        input.disabled = !isEnabled;
        if (slider) slider.disabled = !isEnabled;
      },
    };
  }
}

/** Where a slider stands for a value, and the other way round. */
interface Scale {
  steps: number;
  value: (place: number) => number;
  place: (value: number) => number;
}

/** Null where a slider is of no use: ranges that the eye cannot divide, and those that begin at no number. */
function scaleOf(spec: OptionSpec): Scale | null {
  const ends = kByFactors[spec.name];
  if (ends) {
    const [low, high] = ends;
    const steps = 80;
    return {
      steps,
      value: (place) => Number((low * (high / low) ** (place / steps)).toPrecision(2)),
      place: (value) => (value > 0 ? (steps * Math.log(value / low)) / Math.log(high / low) : 0),
    };
  }
  const [low, high] = [spec.minimum, spec.maximum];
  if (spec.default === null || low === undefined || high === undefined || high - low <= 1) return null;
  const steps = 66;
  return {
    steps,
    value: (place) => low + ((high - low) * place) / steps,
    place: (value) => (steps * (value - low)) / (high - low),
  };
}

/** The values that a preset sets, as its description lists them: "volume: what it is for (a=1, b=2); exact: ...". */
export function presetValues({ description }: OptionSpec, preset: string | null): Values {
  const part = description.split(/[,;]\s*(?=\w+: )/).find((text) => preset !== null && text.startsWith(`${preset}: `));
  return new Map([...(part ?? "").matchAll(/(\w+)=([\w.+-]+)/g)].map((match) => [match[1]!, match[2]!]));
}

/** What a list is after `value`, which is a new list, or has the words that come and go with signs. */
function wordsAfter(defaults: readonly string[], value: string | null): string[] {
  if (value === null) return [...defaults];
  const words = value.split(",");
  if (!words.every((word) => /^[+-]/.test(word))) return words;
  const gone = words.filter((word) => word.startsWith("-")).map((word) => word.slice(1));
  const come = words.filter((word) => word.startsWith("+")).map((word) => word.slice(1));
  return [...defaults.filter((word) => !gone.includes(word)), ...come];
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
