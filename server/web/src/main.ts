// The page: what is there, and what happens when something is asked for.
import { NumberedColours } from "./colouring.ts";
import { type Expected, Forecast } from "./forecast.ts";
import { Inspection, type Told } from "./inspection.ts";
import { forget, keep, recall } from "./kept.ts";
import { Measure } from "./measure.ts";
import { UnreadableMesh } from "./mesh/surface.ts";
import { pictureOf } from "./picture.ts";
import { kSamples } from "./samples.ts";
import { type Post, type Running, ServiceClient, ServiceProblem } from "./service/client.ts";
import type { Capabilities, Job, Problem, Report } from "./service/types.ts";
import { pairsOf, wordsOf } from "./ui/advice.ts";
import { askForKey } from "./ui/key_dialog.ts";
import { askAboutLarge, kLargeResult } from "./ui/large_dialog.ts";
import { byId, h } from "./ui/dom.ts";
import { SurfaceChoice } from "./surface_choice.ts";
import { DownloadPanel, saveBlob } from "./ui/download_panel.ts";
import { FindingsPanel, findingsOf } from "./ui/findings.ts";
import { JobsPanel } from "./ui/jobs_panel.ts";
import { OptionsForm } from "./ui/options_form.ts";
import { ProgressCard } from "./ui/progress_card.ts";
import { qualityPanel, reportTables } from "./ui/report_panel.ts";
import { SurfacesPanel } from "./ui/surfaces_panel.ts";
import { Tabs } from "./ui/tabs.ts";
import { setUpAxis, wireToolbar } from "./ui/toolbar.ts";
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
  private readonly numbers = new NumberedColours(this.viewer);
  private readonly measure = new Measure(this.viewer);
  private readonly forecast = new Forecast(
    (post, watching) => this.service.post(post, watching),
    (expected) => this.showExpected(expected),
  );
  /** Explains the colours anew. */
  private readonly explainColours = wireToolbar({
    viewer: this.viewer,
    numbers: this.numbers,
    kinds: () => this.surfaces.kinds,
    // What was chosen stays only for those who look at surfaces.
    onColouring: () => this.surfaces.hasChosen && this.inspection.clear(),
  });
  private readonly progress = new ProgressCard(
    () => this.running?.cancel(),
    (text) => this.say(text),
  );
  private readonly findings: FindingsPanel;
  private readonly downloads: DownloadPanel;
  private readonly jobs: JobsPanel;
  private readonly tabs: Tabs;
  private options: OptionsForm | null = null;
  private file: File | null = null;
  /** Whether the page could read the file; what the service alone can read is not sent before it is asked for. */
  private isReadable = false;
  /** Told beforehand, since a service that refuses a body need not read it to its end. */
  private mostBytes = Infinity;
  private mostFaces = Infinity;
  private shown: Shown | null = null;
  private running: Running | null = null;
  /** Whether the mesh and the options are kept in the browser. */
  private isKept = false;

  constructor() {
    this.findings = new FindingsPanel(
      byId("findings"),
      (finding) => void this.inspection.mark(finding, -1),
      (finding, index) => this.inspection.goTo(finding, index),
      (options) => this.applyAdvice(options),
    );
    this.downloads = new DownloadPanel(byId("download"), this.service);
    this.jobs = new JobsPanel(byId("jobs"), this.service);
    this.tabs = new Tabs(document.querySelector("[role=tablist]")!, (panel) => {
      this.viewer.showsFindings = panel === "findings";
      this.jobs.isShown = panel === "jobs";
      // A surface that was chosen in its tab is let go with it.
      if (panel !== "surfaces" && this.surfaces.hasChosen && !this.inspection.hasCard) this.inspection.clear();
    });
    this.takeFiles();
    for (const side of kSides) {
      listen(byId(side), side, this.viewer, {
        pick: (where, triangle, x, y) =>
          this.measure.isMeasuring ? this.measure.pick(where, triangle, x, y) : this.inspection.pick(where, triangle),
        clear: () => this.letGo(),
      });
    }
    addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !event.defaultPrevented && !document.querySelector("dialog[open]")) this.letGo();
    });
    byId("picture").addEventListener("click", () => void this.savePicture());
    byId("forget").addEventListener("click", () => void this.forgetMesh());
    byId("setup").addEventListener("submit", (event) => {
      event.preventDefault();
      void this.remesh();
    });
    byId("analyze").addEventListener("click", () => void this.run("v1/analyze"));
    byId("send-job").addEventListener("click", () => void this.run("v1/jobs"));
    byId("reset").addEventListener("click", () => this.options?.reset());
    this.clearResults();
  }

  async start(): Promise<void> {
    try {
      this.meet(await this.service.capabilities());
      const kept = await recall();
      if (kept && !this.file) {
        this.options!.setAll(kept.query);
        await this.open(kept.file);
      }
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
    this.isKept = true;
    this.clearResults();
    this.viewer.show("before", null);
    byId("before-count").textContent = "reading …";
    byId("before-empty").hidden = true;
    byId("summary").hidden = true;
    byId("unreadable").hidden = true;
    byId("kept").hidden = true;
    this.isReadable = false;
    this.optionsChanged();
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
      this.explainColours();
      this.isReadable = true;
      this.optionsChanged();
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
    const report = await this.predict(this.file, query);
    if (report === null) return false;
    if (report === "unknown" || report.predicted_faces <= Math.min(kLargeResult, this.mostFaces)) return true;
    const remedies = report.diagnostics.flatMap(({ code, remedies }) => (code === "many_faces" ? remedies : []));
    const answer = await askAboutLarge(report.predicted_faces, this.mostFaces, remedies);
    if (typeof answer === "object") this.applyAdvice(answer.options);
    else if (answer === "back") this.say("Nothing was remeshed.");
    return answer === "run";
  }

  /** What to expect; null if nothing is to be done any more. */
  private async predict(file: File, query: [string, string][]): Promise<Report | "unknown" | null> {
    const known = this.forecast.of(file, query);
    if (known) return known.report;
    this.begin({ path: "v1/analyze", query, body: file });
    try {
      const { report } = JSON.parse(await (await this.running!.answer).text()) as { report: Report };
      if (this.file !== file) return null;
      this.forecast.learn({ file, query, report });
      return report;
    } catch (error) {
      if (this.file !== file) return null;
      if (!(error instanceof ServiceProblem && error.isCancelled)) return "unknown";
      this.complain(error);
      return null;
    } finally {
      this.end();
    }
  }

  /** Sends it, and shows how far it is. */
  private begin(post: Post): void {
    this.forecast.drop();
    byId("problem").hidden = true;
    byId("after-empty").hidden = true;
    this.progress.start();
    this.running = this.service.post(post, {
      onSent: (part) => this.progress.enter(part < 1 ? "send" : "queued", part < 1 ? part : null),
      onState: (state) => this.progress.show(state),
      onReceived: () => this.progress.enter("receive", null),
    });
    this.enableActions();
    // On a narrow screen the views are below the options.
    this.bringToSight("after");
  }
  private end(): void {
    this.running = null;
    this.progress.end();
    byId("after-empty").hidden = this.viewer.drawable("after") !== null;
    this.enableActions();
  }
  private bringToSight(id: string): void {
    const box = byId(id).getBoundingClientRect();
    if (box.top < innerHeight * 0.7 && box.bottom > 0) return;
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    byId(id).scrollIntoView({ block: "center", behavior: isStill ? "instant" : "smooth" });
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
    this.begin({ path, query: isRemesh ? [...query, ["format", "json"]] : query, body: file });
    try {
      const body = await this.running!.answer;
      // A job is there, whatever was opened meanwhile.
      if (path === "v1/jobs") return this.takeJob(file, JSON.parse(await body.text()) as Job);
      if (this.file !== file) return;
      this.progress.enter("draw", null);
      if (isRemesh) {
        await this.showResult(file, query, body);
      } else {
        const { report } = JSON.parse(await body.text()) as { report: Report };
        this.forecast.learn({ file, query, report });
        this.showReport({ report, query, source: null });
      }
    } catch (error) {
      if (this.file === file) this.complain(error);
    } finally {
      this.end();
    }
  }

  private takeJob(file: File, { id }: Job): void {
    this.jobs.add({ id, file: file.name, sent: Date.now() });
    this.tabs.open(byId("tab-jobs"));
    this.bringToSight("jobs");
    this.say(`${file.name} is job ${id}`);
  }

  private async showResult(file: File, query: [string, string][], body: Blob): Promise<void> {
    const { report, after, before, source, labels } = await this.worker.answer(body);
    if (this.file !== file) return;
    this.inspection.clear();
    this.measure.clear();
    this.numbers.told = labels;
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
    void this.measureDistance();
  }

  /** How far input and result are apart, which takes a while in large meshes. */
  private async measureDistance(): Promise<void> {
    const [before, after] = [this.viewer.drawable("before"), this.viewer.drawable("after")];
    const shown = this.shown;
    if (!before || !after) {
      byId("measured-distance").textContent = "not measured, since the input is not drawn";
      return;
    }
    const deviation = await this.worker.deviation(before.positions, after.positions);
    if (this.shown !== shown) return;
    this.numbers.measured = deviation;
    const length = (part: number): string => real(Number((part * before.frame.radius).toPrecision(3)));
    byId("measured-distance").textContent =
      deviation.max > 0 ? `${length(deviation.max)}, mean ${length(deviation.mean)}` : "none, to rounding";
    this.explainColours();
  }

  private showReport(shown: Shown): void {
    this.shown = this.inspection.told = shown;
    // What an earlier run has marked says nothing of this one.
    this.inspection.clearMarks();
    const { report } = shown;
    if (!report.output) {
      this.viewer.show("after", null);
      this.numbers.told = [];
      byId("after-count").textContent = "";
      this.downloads.setResult(null);
      this.say(
        `Analyzed in ${seconds(report.timing_ms["total"] ?? 0)}: about ${count(report.predicted_faces, "face")} to expect`,
      );
    }
    const up = report.input.up_axis;
    if (up === "x" || up === "y" || up === "z") setUpAxis(this.viewer, up);
    byId("quality").replaceChildren(qualityPanel(report, (options) => this.applyAdvice(options)));
    byId("report").replaceChildren(reportTables(report));
    this.surfaces.tell(report);
    this.explainColours();
    const findings = findingsOf(report, {
      before: this.viewer.drawable("before"),
      after: this.viewer.drawable("after"),
    });
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
    this.measure.clear();
    this.numbers.told = [];
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
    this.bringToSight("problem");
    this.say(`${problem.title ?? "It failed"} ${sentence(detail)}`);
    if (problem.option) this.options?.blame(problem.option);
  }

  private optionsChanged(): void {
    const values = this.options?.values() ?? [];
    byId("reset").hidden = values.length === 0;
    this.downloads.setSettings(this.file?.name ?? "part.obj", values, this.service.hasKey);
    const isStale = this.shown !== null && JSON.stringify(values) !== JSON.stringify(this.shown.query);
    document.body.classList.toggle("stale", isStale);
    this.forecast.change(this.isReadable && this.options?.isValid ? this.file : null, values);
    if (this.file && this.isKept) {
      void keep(this.file, values);
      byId("kept").hidden = false;
    }
  }

  /** What is in force with the options as they are, and how many faces to expect. */
  private showExpected(expected: Expected | null): void {
    const line = byId("forecast");
    line.classList.remove("wrong");
    if (!expected) {
      line.textContent = this.file ? "Faces to expect: not known yet" : "Open a mesh to see how many faces to expect.";
      return;
    }
    const { report } = expected;
    const faces = report.predicted_faces;
    const isTooLarge = faces > this.mostFaces;
    line.textContent =
      `About ${count(faces, "face")} expected` +
      (Number.isFinite(this.mostFaces) ? `, of at most ${whole(this.mostFaces)} here` : "");
    line.classList.toggle("wrong", isTooLarge);
    const inForce = Object.entries(report.options).flatMap(([name, value]): [string, string][] =>
      value === null ? [] : [[name, String(value)]],
    );
    this.options?.tell(new Map(inForce), report.predicted_faces_by_elements_per_circle ?? {}, faces);
  }

  private applyAdvice(options: string): void {
    this.options?.apply(pairsOf(options));
    this.say(`Set: ${wordsOf(options)}. Remesh to see the result.`);
    byId("run").focus();
  }

  private async forgetMesh(): Promise<void> {
    this.isKept = false;
    byId("kept").hidden = true;
    byId("file").focus();
    await forget();
    this.say("It is no longer kept in this browser.");
  }

  private letGo(): void {
    this.inspection.clear();
    this.measure.turn(false);
  }

  private async savePicture(): Promise<void> {
    const name = this.file?.name.replace(/\.[^.]*$/, "") ?? "mesh";
    const captions = kSides.map((side) => {
      const title = `${byId(`${side}-title`).textContent} ${byId(`${side}-count`).textContent}`;
      return { side, text: title.trim() };
    });
    saveBlob(await pictureOf(this.viewer, captions), `${name}.png`);
    this.say(`Saved as ${name}.png`);
  }

  private enableActions(): void {
    const isReady = this.file !== null && this.options !== null && this.running === null;
    for (const id of ["run", "analyze", "send-job"]) byId<HTMLButtonElement>(id).disabled = !isReady;
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
