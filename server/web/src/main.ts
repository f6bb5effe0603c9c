// The page: what is there, and what happens when something is asked for.
import { Inspection, type Told } from "./inspection.ts";
import { UnreadableMesh } from "./mesh/surface.ts";
import { kSamples } from "./samples.ts";
import { type Post, type Running, ServiceClient, ServiceProblem } from "./service/client.ts";
import type { Capabilities, Problem, Report } from "./service/types.ts";
import { askForKey } from "./ui/key_dialog.ts";
import { askAboutLarge, kLargeResult } from "./ui/large_dialog.ts";
import { byId, h } from "./ui/dom.ts";
import { SurfaceChoice } from "./surface_choice.ts";
import { DownloadPanel } from "./ui/download_panel.ts";
import { FindingsPanel, findingsOf } from "./ui/findings.ts";
import { OptionsForm } from "./ui/options_form.ts";
import { ProgressCard } from "./ui/progress_card.ts";
import { qualityPanel, reportTables } from "./ui/report_panel.ts";
import { SurfacesPanel } from "./ui/surfaces_panel.ts";
import { Tabs } from "./ui/tabs.ts";
import { wireToolbar } from "./ui/toolbar.ts";
import { count, degrees, real, seconds, sentence, whole } from "./ui/words.ts";
import { listen } from "./view/gestures.ts";
import { Viewer, kSides } from "./view/viewer.ts";
import { WorkerClient } from "./worker_client.ts";

/** Options that may ask for far more faces than the input has. By default, results are in proportion to the input. */
const kSizes = [
  "preset",
  "target_faces",
  "target_edge_length",
  "max_edge_length",
  "max_edge_fraction",
  "max_area",
  "min_edge_length",
  "proximity",
  "gradation",
  "elements_per_circle",
];

/** A remeshing or an analysis that is on the screen. */
interface Shown extends Told {
  /** As asked for, without the format. */
  query: [string, string][];
}

class Page {
  private readonly service = new ServiceClient(askForKey);
  private readonly worker = new WorkerClient();
  private readonly viewer = new Viewer(byId<HTMLCanvasElement>("canvas"), {
    before: byId("before"),
    after: byId("after"),
  });
  private readonly surfaces = new SurfaceChoice(
    this.viewer,
    new SurfacesPanel(byId("surfaces"), (ids) => this.inspection.chooseSurfaces(ids)),
  );
  private readonly inspection: Inspection = new Inspection(this.viewer, this.surfaces);
  /** Explains the colours anew. */
  private readonly explainColours = wireToolbar(this.viewer, () => this.surfaces.kinds);
  private readonly progress = new ProgressCard(
    () => this.running?.cancel(),
    (text) => this.say(text),
  );
  private readonly findings: FindingsPanel;
  private readonly downloads: DownloadPanel;
  private options: OptionsForm | null = null;
  private file: File | null = null;
  /** Told beforehand, since a service that refuses a body need not read it to its end. */
  private mostBytes = Infinity;
  private mostFaces = Infinity;
  private shown: Shown | null = null;
  private running: Running | null = null;

  constructor() {
    this.findings = new FindingsPanel(
      byId("findings"),
      (finding) => void this.inspection.mark(finding, -1),
      (finding, index) => this.inspection.goTo(finding, index),
    );
    this.downloads = new DownloadPanel(byId("download"), this.service);
    new Tabs(document.querySelector("[role=tablist]")!, (panel) => (this.viewer.showsFindings = panel === "findings"));
    this.takeFiles();
    for (const side of kSides) {
      listen(byId(side), side, this.viewer, {
        pick: (where, triangle) => this.inspection.pick(where, triangle),
        clear: () => this.inspection.clear(),
      });
    }
    byId("setup").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.remesh();
    });
    byId("analyze").addEventListener("click", () => void this.run("v1/analyze"));
    byId("reset").addEventListener("click", () => this.options?.reset());
    this.clearResults();
  }

  async start(): Promise<void> {
    try {
      this.meet(await this.service.capabilities());
    } catch (error) {
      byId("options").replaceChildren(
        h("p", { class: "notice" }, "The service did not answer. Reload the page to try again."),
      );
      this.complain(error);
    }
  }

  private meet(capabilities: Capabilities): void {
    byId("version").textContent = capabilities.versions.remeshd;
    byId("formats").textContent =
      capabilities.formats.input.flatMap(({ endings }) => endings.map((ending) => ending.toUpperCase())).join(", ") +
      " (.gz)";
    this.options = new OptionsForm(byId("options"), capabilities.options, () => this.optionsChanged());
    this.mostBytes = capabilities.limits["max_body"] ?? Infinity;
    this.mostFaces = capabilities.limits["max_output_faces"] ?? Infinity;
    this.downloads.offer(capabilities.formats.output);
    this.optionsChanged();
  }

  // ---- the mesh

  private takeFiles(): void {
    const input = byId<HTMLInputElement>("file");
    input.addEventListener("change", () => {
      if (input.files?.[0]) void this.open(input.files[0]);
      input.value = "";
    });
    byId("samples").replaceChildren(
      h("span", { class: "muted" }, "Samples"),
      ...kSamples.map((sample) =>
        h(
          "button",
          { type: "button", class: "quiet", click: () => void this.open(new File([sample.obj()], sample.file)) },
          sample.name,
        ),
      ),
    );
    let depth = 0;
    const over = (isOver: boolean): void => void document.body.classList.toggle("dropping", isOver);
    addEventListener("dragenter", () => over(++depth > 0));
    addEventListener("dragleave", () => over(--depth > 0));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      over((depth = 0) > 0);
      const file = event.dataTransfer?.files[0];
      if (file) void this.open(file);
    });
  }

  private async open(file: File): Promise<void> {
    this.running?.cancel();
    this.file = file;
    this.clearResults();
    this.viewer.show("before", null);
    byId("before-count").textContent = "reading …";
    byId("before-empty").hidden = true;
    byId("summary").hidden = true;
    byId("unreadable").hidden = true;
    this.enableActions();
    this.say(`Reading ${file.name}`);
    try {
      const opened = await this.worker.open(file);
      if (this.file !== file) return;
      this.viewer.show("before", opened.drawable);
      this.viewer.reset();
      byId("before-count").textContent = count(opened.faces, "face");
      this.summarise(file, [
        ["Faces", whole(opened.faces)],
        ["Vertices", whole(opened.points)],
        ["Extent", opened.size.map(real).join(" × ")],
        ["Smallest angle", degrees(opened.minAngle)],
        ["Open edges", whole(opened.drawable.openEdges)],
      ]);
      this.say(`${file.name}: ${count(opened.faces, "face")}`);
    } catch (error) {
      if (this.file !== file) return;
      const why = error instanceof UnreadableMesh ? error.message : `It cannot be drawn: ${String(error)}`;
      this.summarise(file, []);
      byId("before-count").textContent = "";
      byId("unreadable").textContent = `${why} So it is not drawn here. Remesh it to see what the service says.`;
      byId("unreadable").hidden = false;
      this.say(why);
    }
  }

  private summarise(file: File, facts: [string, string][]): void {
    const rows = [["File", `${file.name}, ${sizeOf(file.size)}`] as [string, string], ...facts];
    byId("summary").replaceChildren(
      ...rows.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value))),
    );
    byId("summary").hidden = false;
  }

  // ---- a run

  private async remesh(): Promise<void> {
    if (await this.isWanted()) await this.run("v1/remesh");
  }

  /** Whether a remeshing would not be large, or is wanted all the same. */
  private async isWanted(): Promise<boolean> {
    if (!this.file || !this.options || this.running) return false;
    // What is wrong with these is told by the run.
    if (this.file.size > this.mostBytes || !this.options.check()) return true;
    const query = this.options.values();
    if (!query.some(([name]) => kSizes.includes(name))) return true;
    const predicted = await this.predict(this.file, query);
    if (predicted === null) return false;
    if (predicted > this.mostFaces) {
      const faces = `about ${whole(predicted)} faces are expected, and this service makes at most ${whole(this.mostFaces)}`;
      this.complain(new Error(`${faces}: ask for larger edges, or for a number of faces`));
      return false;
    }
    return predicted <= kLargeResult || (await askAboutLarge(predicted));
  }

  /** The number of faces to expect; 0 if the service cannot tell, and null if nothing is to be done any more. */
  private async predict(file: File, query: [string, string][]): Promise<number | null> {
    const { shown } = this;
    if (shown && !shown.report.output && JSON.stringify(shown.query) === JSON.stringify(query))
      return shown.report.predicted_faces;
    byId("problem").hidden = true;
    this.progress.start();
    this.running = this.service.post(
      { path: "v1/analyze", query, body: file },
      {
        onSent: (part) => this.progress.enter(part < 1 ? "send" : "queued", part < 1 ? part : null),
        onState: (state) => this.progress.show(state),
        onReceived: () => this.progress.enter("receive", null),
      },
    );
    this.enableActions();
    try {
      const { report } = JSON.parse(await (await this.running.answer).text()) as { report: Report };
      return this.file === file ? report.predicted_faces : null;
    } catch (error) {
      if (this.file !== file) return null;
      if (!(error instanceof ServiceProblem && error.isCancelled)) return 0;
      this.complain(error);
      return null;
    } finally {
      this.running = null;
      this.progress.end();
      this.enableActions();
    }
  }

  private async run(path: Post["path"]): Promise<void> {
    if (!this.file || !this.options || this.running) return;
    if (this.file.size > this.mostBytes) {
      return this.complain(
        new Error(`the file has ${sizeOf(this.file.size)}; this service takes at most ${sizeOf(this.mostBytes)}`),
      );
    }
    if (!this.options.check()) return this.say("An option is out of its range.");
    const file = this.file;
    const query = this.options.values();
    const isRemesh = path === "v1/remesh";
    byId("problem").hidden = true;
    byId("after-empty").hidden = true;
    this.progress.start();
    this.running = this.service.post(
      { path, query: isRemesh ? [...query, ["format", "json"]] : query, body: file },
      {
        onSent: (part) => this.progress.enter(part < 1 ? "send" : "queued", part < 1 ? part : null),
        onState: (state) => this.progress.show(state),
        onReceived: () => this.progress.enter("receive", null),
      },
    );
    this.enableActions();
    try {
      const body = await this.running.answer;
      if (this.file !== file) return;
      this.progress.enter("draw", null);
      if (isRemesh) await this.showResult(file, query, body);
      else
        this.showReport({ report: (JSON.parse(await body.text()) as { report: Report }).report, query, source: null });
    } catch (error) {
      if (this.file === file) this.complain(error);
    } finally {
      this.running = null;
      this.progress.end();
      byId("after-empty").hidden = this.viewer.drawable("after") !== null;
      this.enableActions();
    }
  }

  private async showResult(file: File, query: [string, string][], body: Blob): Promise<void> {
    const { report, after, before, source } = await this.worker.answer(body);
    if (this.file !== file) return;
    this.inspection.clear();
    this.viewer.show("after", after);
    if (before) this.viewer.recolour("before", before);
    if (!this.viewer.drawable("before")) this.viewer.reset();
    this.downloads.setResult({ file, query, json: body });
    this.showReport({ report, query, source });
    const output = report.output!;
    byId("after-count").textContent = count(output.faces, "face");
    this.say(
      `Remeshed in ${seconds(report.timing_ms["total"] ?? 0)}: ${whole(report.input.faces)} faces became ${whole(output.faces)}, ` +
        `smallest angle ${degrees(output.quality.min_angle_deg)}`,
    );
  }

  private showReport(shown: Shown): void {
    this.shown = this.inspection.told = shown;
    // What an earlier run has marked says nothing of this one.
    this.inspection.clearMarks();
    const { report } = shown;
    if (!report.output) {
      this.viewer.show("after", null);
      byId("after-count").textContent = "";
      this.downloads.setResult(null);
      this.say(
        `Analyzed in ${seconds(report.timing_ms["total"] ?? 0)}: about ${count(report.predicted_faces, "face")} to expect`,
      );
    }
    byId("quality").replaceChildren(qualityPanel(report));
    byId("report").replaceChildren(reportTables(report));
    this.surfaces.tell(report);
    this.explainColours();
    const findings = findingsOf(report);
    byId("tab-findings").replaceChildren(
      "Findings",
      ...(findings.length > 0 ? [" ", h("span", { class: "badge" }, whole(findings.length))] : []),
    );
    this.findings.show(findings);
    this.optionsChanged();
  }

  private clearResults(): void {
    this.shown = this.inspection.told = null;
    this.inspection.clear();
    this.inspection.clearMarks();
    this.viewer.show("after", null);
    byId("after-count").textContent = "";
    byId("after-empty").hidden = false;
    byId("problem").hidden = true;
    this.surfaces.tell(null);
    this.explainColours();
    for (const id of ["quality", "surfaces", "report", "findings"]) {
      byId(id).replaceChildren(h("p", { class: "nothing" }, "Remesh or analyze a mesh to see this."));
    }
    byId("tab-findings").replaceChildren("Findings");
    this.downloads.setResult(null);
    this.optionsChanged();
  }

  private complain(error: unknown): void {
    if (error instanceof ServiceProblem && error.isCancelled) return this.say("Cancelled");
    const problem: Partial<Problem> =
      error instanceof ServiceProblem
        ? error.problem
        : { title: "This cannot be done:", detail: error instanceof Error ? error.message : String(error) };
    const place = (["line", "byte", "element"] as const)
      .filter((key) => problem[key] !== undefined)
      .map((key) => `${key} ${whole(problem[key]!)}`);
    if (problem.limit !== undefined) place.push(`limit ${whole(problem.limit)}`);
    const detail = problem.detail ?? "";
    byId("problem").replaceChildren(
      h("p", {}, h("strong", {}, problem.title ?? "It failed"), " ", sentence(detail)),
      h(
        "p",
        { class: "muted" },
        [...place, problem.code && `code ${problem.code}`, problem.request_id && `request ${problem.request_id}`]
          .filter(Boolean)
          .join(" · "),
      ),
      h(
        "button",
        { type: "button", class: "quiet close", "aria-label": "Dismiss", click: () => (byId("problem").hidden = true) },
        "×",
      ),
    );
    byId("problem").hidden = false;
    this.say(`${problem.title ?? "It failed"} ${sentence(detail)}`);
    if (problem.option) this.options?.blame(problem.option);
  }

  private optionsChanged(): void {
    const values = this.options?.values() ?? [];
    byId("reset").hidden = values.length === 0;
    this.downloads.setSettings(this.file?.name ?? "part.obj", values, this.service.hasKey);
    const isStale = this.shown !== null && JSON.stringify(values) !== JSON.stringify(this.shown.query);
    document.body.classList.toggle("stale", isStale);
  }

  private enableActions(): void {
    const isReady = this.file !== null && this.options !== null && this.running === null;
    byId<HTMLButtonElement>("run").disabled = !isReady;
    byId<HTMLButtonElement>("analyze").disabled = !isReady;
  }

  private say(text: string): void {
    byId("status").textContent = text;
  }
}

function sizeOf(bytes: number): string {
  if (bytes < 1000) return count(bytes, "byte");
  const [size, unit] = bytes < 1e6 ? [bytes / 1e3, "kB"] : [bytes / 1e6, "MB"];
  return `${real(Number(size.toPrecision(3)))} ${unit}`;
}

try {
  void new Page().start();
} catch (error) {
  // A browser without WebGL 2, mostly.
  const why = error instanceof Error ? error.message : String(error);
  byId("problem").replaceChildren(h("p", {}, h("strong", {}, "This browser cannot draw the page."), ` ${why}`));
  byId("problem").hidden = false;
}
