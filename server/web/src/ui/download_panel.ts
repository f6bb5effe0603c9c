import { curlLine, resultName } from "../service/curl.ts";
import { type ServiceClient, ServiceProblem } from "../service/client.ts";
import type { Format } from "../service/types.ts";
import { h } from "./dom.ts";

export interface Result {
  file: File;
  query: [string, string][];
  json: Blob;
}

/** The result in every format, and the line of a shell that makes it. */
export class DownloadPanel {
  private readonly buttons = h("div", { class: "formats", role: "group", "aria-label": "Formats" });
  private readonly note = h("p", { class: "muted", role: "status" });
  private readonly line = h("code", { id: "curl", tabindex: "0", role: "region", "aria-label": "The curl command" });
  private readonly copy = h("button", { type: "button", class: "quiet", click: () => void this.copyLine() }, "Copy");
  private readonly format = h("select", { "aria-label": "Format of the curl line", change: () => this.showLine() });
  private readonly programs = h("dl", { class: "facts", id: "programs" });
  private result: Result | null = null;
  private formats: Format[] = [];
  private settings: { file: string; query: [string, string][]; hasKey: boolean } = {
    file: "part.obj",
    query: [],
    hasKey: false,
  };

  constructor(
    panel: HTMLElement,
    private readonly service: ServiceClient,
  ) {
    panel.replaceChildren(
      h(
        "div",
        { class: "download" },
        h(
          "section",
          { "aria-labelledby": "files-title" },
          h("h3", { id: "files-title" }, "The result as a file"),
          this.buttons,
          this.note,
        ),
        h(
          "section",
          { "aria-labelledby": "curl-title" },
          h("h3", { id: "curl-title" }, "The same request from a shell"),
          h("div", { class: "curl-row" }, h("label", { class: "inline" }, "as ", this.format), this.copy),
          this.line,
          this.programs,
        ),
      ),
    );
  }

  offer(formats: Format[]): void {
    this.formats = formats;
    this.buttons.replaceChildren(
      ...formats.map(({ name, media_type, about }) =>
        h(
          "button",
          { type: "button", disabled: true, "data-format": name, title: media_type, click: () => void this.save(name) },
          h("strong", {}, titleOf(name)),
          h("span", { class: "muted" }, about),
        ),
      ),
    );
    this.format.replaceChildren(...formats.map(({ name }) => h("option", { value: name }, name)));
    this.showLine();
  }

  setResult(result: Result | null): void {
    this.result = result;
    this.note.textContent = result
      ? "To save another format than JSON, the service remeshes again. The same input and options give the same bytes."
      : "Remesh a mesh first.";
    for (const button of this.buttons.querySelectorAll("button")) button.disabled = result === null;
  }

  setSettings(file: string, query: [string, string][], hasKey: boolean): void {
    this.settings = { file, query, hasKey };
    this.showLine();
  }

  private showLine(): void {
    const { file, query, hasKey } = this.settings;
    const format = this.format.value || "obj";
    this.line.textContent = curlLine(
      new URL(".", location.href).href,
      file,
      query,
      format,
      this.endingOf(format),
      hasKey,
    );
    const programs = this.formats.find(({ name }) => name === format)?.programs ?? [];
    this.programs.replaceChildren(
      ...programs.flatMap(({ program, takes, lines }) => [
        h("dt", {}, program),
        h("dd", {}, `${takes} `, ...lines.flatMap((line) => [h("br"), h("code", {}, line)])),
      ]),
    );
  }

  private endingOf(format: string): string {
    return this.formats.find(({ name }) => name === format)?.ending ?? format;
  }

  private async save(format: string): Promise<void> {
    if (!this.result) return;
    const { file, query, json } = this.result;
    for (const button of this.buttons.querySelectorAll("button")) button.disabled = true;
    try {
      if (format !== "json") this.note.textContent = `Making ${titleOf(format)} …`;
      const nothing = (): void => {};
      const blob =
        format === "json"
          ? json
          : await this.service.post(
              { path: "v1/remesh", query: [...query, ["format", format]], body: file },
              { onSent: nothing, onState: nothing, onReceived: nothing },
            ).answer;
      const name = resultName(file.name, this.endingOf(format));
      saveBlob(blob, name);
      const origin = await originOf(blob);
      this.note.textContent = `Saved as ${name}.${origin ? ` Its coordinates are relative to the origin ${origin}.` : ""}`;
    } catch (error) {
      this.note.textContent = error instanceof ServiceProblem ? error.problem.detail : String(error);
    } finally {
      for (const button of this.buttons.querySelectorAll("button")) button.disabled = this.result === null;
    }
  }

  private async copyLine(): Promise<void> {
    try {
      await navigator.clipboard.writeText(this.line.textContent ?? "");
      this.copy.textContent = "Copied";
    } catch {
      // Pages that did not come by TLS or from this machine may not write there: it is selected, to be copied by hand.
      getSelection()?.selectAllChildren(this.line);
      this.copy.textContent = "Selected";
    }
    setTimeout(() => (this.copy.textContent = "Copy"), 1500);
  }
}

/** The origin that the header of a binary STL names, if it is one and names one. */
async function originOf(blob: Blob): Promise<string | null> {
  const header = await blob.slice(0, 80).text();
  return /^binary STL.*, origin ([^ ,]+ [^ ,]+ [^ ,]+)/.exec(header)?.[1] ?? null;
}

/** `stl_ascii` as a title: STL ASCII. */
function titleOf(format: string): string {
  return format.toUpperCase().replaceAll("_", " ");
}

export function saveBlob(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
