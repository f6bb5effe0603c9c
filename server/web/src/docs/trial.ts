// The form that sends an operation to the service.
import { type ServiceClient, ServiceProblem } from "../service/client.ts";
import { shellWord } from "../service/curl.ts";
import { saveBlob } from "../ui/download_panel.ts";
import { h } from "../ui/dom.ts";
import type { Body, Parameter, Placed, Schema } from "./contract.ts";
import { prose } from "./prose.ts";
import { summaryOf } from "./schema_view.ts";

type Field = HTMLInputElement | HTMLSelectElement;

/** Longer texts are saved instead. */
const kMostShown = 20_000;

interface Example {
  name: string;
  type: string;
  text: string;
}

/** What there is to send without a file of one's own. */
function examplesOf(body: Body): Example[] {
  return Object.entries(body.content).flatMap(([type, { example, examples = {} }]): Example[] => [
    ...Object.values(examples).map(({ summary, value }) => ({ name: summary, type, text: JSON.stringify(value) })),
    ...(typeof example === "string" ? [{ name: `A file of ${type}`, type, text: example }] : []),
  ]);
}

function fieldOf({ name, schema, example, required }: Parameter, id: string): Field {
  const values = schema.enum ?? (schema.type === "boolean" ? [true, false] : null);
  if (values)
    return h(
      "select",
      { id, "data-name": name },
      ...["", ...values].map((value) => h("option", { value: String(value) }, String(value))),
    );
  const shown = schema.default ?? example;
  return h("input", {
    type: "text",
    id,
    "data-name": name,
    autocomplete: "off",
    spellcheck: "false",
    required: required === true,
    placeholder: shown === undefined ? null : String(shown),
  });
}

/** Parts of a form: files and texts. */
function partsOf(body: Body | null): [string, Schema][] {
  const form = body?.content["multipart/form-data"]?.schema;
  return body && !body.content["application/json"] && form ? Object.entries(form.properties ?? {}) : [];
}

export class Trial {
  readonly element: HTMLFormElement;
  private readonly fields: [Parameter, Field][];
  private readonly parts: [string, HTMLInputElement][];
  private readonly examples: Example[];
  private readonly choice: HTMLSelectElement;
  private readonly file = h("input", { type: "file", "aria-label": "A file to send instead" });
  private readonly text: HTMLTextAreaElement;
  private readonly line = h("code", { class: "line", tabindex: "0", role: "group", "aria-label": "The curl command" });
  private readonly answer = h("div", { class: "answer", role: "status" });
  private readonly send = h("button", { type: "submit", class: "primary" }, "Send");
  private readonly stop = h("button", { type: "button", hidden: true, click: () => this.ending?.abort() }, "Stop");
  private ending: AbortController | null = null;

  /** `sample` is a mesh file for the files of a form; `onJob` is told the id of a job that an answer is about. */
  constructor(
    private readonly placed: Placed,
    private readonly service: ServiceClient,
    private readonly sample: string,
    private readonly onJob: (id: string) => void,
  ) {
    const id = placed.operation.operationId;
    this.fields = placed.parameters.map((parameter) => [parameter, fieldOf(parameter, `${id}-${parameter.name}`)]);
    this.parts = partsOf(placed.body).map(([name, { contentMediaType }]) => [
      name,
      h("input", { type: contentMediaType ? "file" : "text", id: `${id}-part-${name}` }),
    ]);
    this.examples = placed.body ? examplesOf(placed.body) : [];
    this.choice = h(
      "select",
      { "aria-label": "Example", change: () => this.takeExample() },
      ...this.examples.map(({ name }, i) => h("option", { value: i }, name)),
    );
    this.text = h("textarea", { rows: "5", "aria-label": "The body", spellcheck: "false" });
    this.element = h(
      "form",
      { class: "trial", novalidate: true, input: () => this.showLine() },
      ...this.rows(),
      ...this.bodyRows(),
      h("div", { class: "trial-line" }, this.line),
      h("div", { class: "actions" }, this.send, this.stop),
      this.answer,
    );
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      void this.run();
    });
    this.takeExample();
  }

  /** Fills in a parameter of the path. */
  setPath(name: string, value: string): void {
    for (const [parameter, field] of this.fields)
      if (parameter.in === "path" && parameter.name === name) field.value = value;
    this.showLine();
  }

  private rows(): HTMLElement[] {
    if (this.fields.length === 0) return [];
    const rows = this.fields.map(([parameter, field]) =>
      h(
        "div",
        { class: "parameter" },
        h(
          "div",
          { class: "parameter-head" },
          h("label", { for: field.id }, h("code", {}, parameter.name)),
          h(
            "span",
            { class: "muted" },
            `${parameter.in === "header" ? "field of the head" : parameter.in}; `,
            summaryOf({ ...parameter.schema }, parameter.required),
          ),
          field,
        ),
        ...prose(parameter.description),
      ),
    );
    const isOpen = this.fields.some(([{ required }]) => required) || this.fields.length < 5;
    return [h("details", { open: isOpen }, h("summary", {}, `Parameters (${this.fields.length})`), ...rows)];
  }

  private bodyRows(): HTMLElement[] {
    const { body } = this.placed;
    if (!body) return [];
    const types = Object.keys(body.content).join(", ");
    const head = [h("h4", {}, "Body"), ...prose(body.description), h("p", { class: "muted" }, types)];
    if (this.parts.length === 0)
      return [...head, h("div", { class: "example" }, this.choice, " or ", this.file), this.text];
    const schemas = new Map(partsOf(body));
    return [
      ...head,
      h("p", {}, "A file that is not chosen is the example of another operation: a square."),
      ...this.parts.map(([name, input]) =>
        h(
          "div",
          { class: "parameter" },
          h("div", { class: "parameter-head" }, h("label", { for: input.id }, h("code", {}, name)), input),
          ...prose(schemas.get(name)?.description),
        ),
      ),
    ];
  }

  private takeExample(): void {
    this.text.value = this.examples[Number(this.choice.value)]?.text ?? "";
    this.showLine();
  }

  private values(place: Parameter["in"]): [string, string][] {
    return this.fields.flatMap(([parameter, field]): [string, string][] =>
      parameter.in === place && field.value !== "" ? [[parameter.name, field.value]] : [],
    );
  }
  private get path(): string {
    const filled = this.values("path").reduce(
      (path, [name, value]) => path.replace(`{${name}}`, encodeURIComponent(value)),
      this.placed.path,
    );
    const query = this.values("query").map(
      ([name, value]) => `${name}=${encodeURIComponent(value).replaceAll("%2C", ",")}`,
    );
    // Relative, so that the page works below any path that a proxy gives it.
    return filled.slice(1) + (query.length > 0 ? `?${query.join("&")}` : "");
  }
  private get type(): string {
    return this.file.files?.[0] ? "application/octet-stream" : (this.examples[Number(this.choice.value)]?.type ?? "");
  }
  private get body(): BodyInit | null {
    if (this.parts.length > 0) {
      const form = new FormData();
      for (const [name, input] of this.parts) {
        if (input.type === "file") form.append(name, input.files?.[0] ?? new File([this.sample], `${name}.obj`));
        else if (input.value !== "") form.append(name, input.value);
      }
      return form;
    }
    return this.placed.body ? (this.file.files?.[0] ?? this.text.value) : null;
  }

  private showLine(): void {
    const parts = this.parts.flatMap(([name, input]) => {
      if (input.type === "file") return [`-F ${shellWord(`${name}=@${input.files?.[0]?.name ?? `${name}.obj`}`)}`];
      return input.value === "" ? [] : [`-F ${shellWord(`${name}=${input.value}`)}`];
    });
    const file = this.file.files?.[0];
    const body = file
      ? [`--data-binary ${shellWord(`@${file.name}`)}`]
      : [`-H 'Content-Type: ${this.type}'`, `--data-binary ${shellWord(this.text.value)}`];
    this.line.textContent = [
      "curl",
      ...(this.placed.method === "delete" ? ["-X DELETE"] : []),
      ...(this.service.hasKey ? ['-H "Authorization: Bearer $REMESHD_API_KEY"'] : []),
      ...this.values("header").map(([name, value]) => `-H ${shellWord(`${name}: ${value}`)}`),
      ...parts,
      ...(this.placed.body && this.parts.length === 0 ? body : []),
      shellWord(decodeURI(new URL(this.path, document.baseURI).href)),
    ].join(" ");
  }

  private async run(): Promise<void> {
    const missing = this.fields.find(([{ required }, field]) => required && field.value === "");
    if (missing) {
      this.answer.replaceChildren(h("p", { class: "notice" }, `${missing[0].name} is needed.`));
      return missing[1].focus();
    }
    this.ending = new AbortController();
    this.send.disabled = true;
    this.stop.hidden = false;
    this.answer.replaceChildren(h("p", { class: "muted" }, "Waiting for the answer …"));
    try {
      const body = this.body;
      const headers = Object.fromEntries(this.values("header"));
      // The browser itself writes the type of a form, with its boundary.
      if (typeof body === "string") headers["Content-Type"] = this.type;
      else if (body instanceof File) headers["Content-Type"] = "application/octet-stream";
      await this.show(
        await this.service.send(this.path, {
          method: this.placed.method.toUpperCase(),
          headers,
          body,
          signal: this.ending.signal,
        }),
      );
    } catch (error) {
      const text = error instanceof ServiceProblem ? error.problem.detail : String(error);
      this.answer.append(h("p", { class: "notice" }, this.ending.signal.aborted ? "Stopped." : text));
    } finally {
      this.send.disabled = false;
      this.stop.hidden = true;
      this.showLine();
    }
  }

  private async show(response: Response): Promise<void> {
    const type = response.headers.get("Content-Type") ?? "";
    const text = h("pre", { tabindex: "0", role: "group", "aria-label": "The body of the answer" });
    this.answer.replaceChildren(
      h("p", {}, h("strong", { class: response.ok ? "good" : "poor" }, `${response.status} ${response.statusText}`)),
      h(
        "pre",
        { class: "muted", tabindex: "0", role: "group", "aria-label": "The fields of the answer" },
        [...response.headers].map(([name, value]) => `${name}: ${value}`).join("\n"),
      ),
    );
    const chunks: Uint8Array<ArrayBuffer>[] = [];
    const isText = /json|text|xml|obj|off|charset/.test(type);
    if (isText) this.answer.append(text);
    const decoder = new TextDecoder();
    // Streams are shown as they come.
    for (const reader = response.body?.getReader(); reader; ) {
      const { done, value } = await reader.read();
      if (done) break;
      chunks.push(value);
      if (isText && text.textContent!.length < kMostShown) text.append(decoder.decode(value, { stream: true }));
    }
    const blob = new Blob(chunks, { type });
    if (blob.size === 0) return text.remove();
    if (type.includes("json")) this.showJson(text, await blob.text());
    const isCut = !isText || text.textContent!.length > kMostShown;
    if (isCut) text.textContent = text.textContent!.slice(0, kMostShown);
    this.answer.append(
      h(
        "p",
        {},
        isText && isCut && "The rest is in the file. ",
        h(
          "button",
          { type: "button", click: () => saveBlob(blob, `answer${endingOf(response, type)}`) },
          `Save ${blob.size} bytes`,
        ),
      ),
    );
  }

  private showJson(text: HTMLElement, json: string): void {
    try {
      const value = JSON.parse(json) as { id?: unknown; links?: unknown };
      text.textContent = JSON.stringify(value, null, 2);
      if (typeof value.id === "string" && value.links) this.onJob(value.id);
    } catch {
      text.textContent = json;
    }
  }
}

function endingOf(response: Response, type: string): string {
  const named = /filename="[^"]*(\.[^".]*)"/.exec(response.headers.get("Content-Disposition") ?? "");
  return named?.[1] ?? (type.includes("json") ? ".json" : ".txt");
}
