import { type OwnJob, forgetJob, keepJob, ownJobs } from "../own_jobs.ts";
import { type ServiceClient, ServiceProblem } from "../service/client.ts";
import type { Job } from "../service/types.ts";
import { byId, h } from "./dom.ts";
import { saveBlob } from "./download_panel.ts";
import { label, sentence, whole } from "./words.ts";

/** How often a job that goes on is asked for while the panel is open. */
const kAskMs = 1000;

interface Row {
  job: OwnJob;
  state: HTMLElement;
  save: HTMLButtonElement;
  element: HTMLElement;
  isOver: boolean;
}

/** The jobs that were sent from this browser: their states, links, results, and ways to be rid of them. */
export class JobsPanel {
  private readonly rows = h("tbody");
  private readonly table = h(
    "table",
    { class: "numbers-table jobs" },
    h(
      "thead",
      {},
      h("tr", {}, ...["File", "Job", "State", "Actions"].map((title) => h("th", { scope: "col" }, title))),
    ),
    this.rows,
  );
  private readonly note = h("p", { class: "muted", role: "status" });
  private listed: Row[] = [];
  private isOpen = false;
  private timer = 0;

  constructor(
    private readonly panel: HTMLElement,
    private readonly service: ServiceClient,
  ) {
    this.list();
  }

  /** A job that has just been sent. */
  add(job: OwnJob): void {
    keepJob(job);
    this.list();
  }

  /** Only what is seen is asked for. */
  set isShown(isShown: boolean) {
    if (isShown && !this.isOpen) this.list();
    this.isOpen = isShown;
    clearTimeout(this.timer);
    if (isShown) void this.ask();
  }

  private list(): void {
    const known = new Map(this.listed.map((row) => [row.job.id, row]));
    this.listed = ownJobs().map((job) => known.get(job.id) ?? this.rowOf(job));
    this.rows.replaceChildren(...this.listed.map(({ element }) => element));
    byId("tab-jobs").replaceChildren(
      "Jobs",
      ...(this.listed.length > 0 ? [" ", h("span", { class: "badge" }, whole(this.listed.length))] : []),
    );
    this.panel.replaceChildren(
      ...(this.listed.length > 0
        ? [
            h(
              "p",
              { class: "muted" },
              "This list is kept in this browser alone. Where the service asks for no key, whoever has a job's address can read and delete it.",
            ),
            this.table,
            this.note,
          ]
        : [
            h(
              "p",
              { class: "nothing" },
              "“As a job” sends a mesh whose result is fetched later; it is then listed here.",
            ),
          ]),
    );
  }

  private rowOf(job: OwnJob): Row {
    const button = (text: string, title: string, click: () => void): HTMLButtonElement =>
      h("button", { type: "button", class: "quiet", title, "aria-label": `${text} ${job.file}`, click }, text);
    const state = h("td", {}, "…");
    const save = button("Save", "Saves the result", () => void this.save(row));
    save.disabled = true;
    const shortId = `${job.id.slice(0, 8)}…`;
    const row: Row = {
      job,
      state,
      save,
      isOver: false,
      element: h(
        "tr",
        { "data-job": job.id },
        h("th", { scope: "row", title: new Date(job.sent).toLocaleString() }, job.file),
        // A link has no key.
        h("td", {}, this.service.hasKey ? shortId : h("a", { href: `v1/jobs/${job.id}`, title: job.id }, shortId)),
        state,
        h(
          "td",
          { class: "actions" },
          save,
          button(
            "Delete",
            "Cancels the job, and deletes its mesh and result on the service",
            () => void this.delete(row),
          ),
          button("Forget", "Takes the job off this list; the service keeps it until it expires", () =>
            this.forget(row),
          ),
        ),
      ),
    };
    return row;
  }

  private async ask(): Promise<void> {
    await Promise.all(this.listed.filter(({ isOver }) => !isOver).map((row) => this.askFor(row)));
    clearTimeout(this.timer);
    if (this.isOpen && this.listed.some(({ isOver }) => !isOver))
      this.timer = window.setTimeout(() => void this.ask(), kAskMs);
  }

  private async askFor(row: Row): Promise<void> {
    try {
      const job = (await (await this.service.ask(`v1/jobs/${row.job.id}`)).json()) as Job;
      row.isOver = job.state !== "queued" && job.state !== "running";
      row.save.disabled = job.state !== "succeeded";
      row.state.textContent =
        job.state === "running" ? `Running, ${Math.round(100 * job.fraction)} %` : label(job.state);
      if (job.problem) row.state.append(`: ${sentence(job.problem.detail)}`);
    } catch (error) {
      row.isOver = error instanceof ServiceProblem && error.problem.status === 404;
      row.state.textContent = row.isOver ? "Not on this service any more" : textOf(error);
    }
  }

  private async save({ job }: Row): Promise<void> {
    await this.tried(async () => {
      const response = await this.service.ask(`v1/jobs/${job.id}/result`);
      const ending = /filename="[^"]*(\.[^".]*)"/.exec(response.headers.get("Content-Disposition") ?? "")?.[1] ?? "";
      const name = `${job.file.replace(/\.gz$/i, "").replace(/\.[^.]*$/, "")}-remeshed${ending}`;
      saveBlob(await response.blob(), name);
      return `Saved as ${name}`;
    });
  }

  private async delete(row: Row): Promise<void> {
    await this.tried(async () => {
      await this.service.ask(`v1/jobs/${row.job.id}`, "DELETE");
      this.forget(row);
      return `${row.job.file} was deleted.`;
    });
  }

  private forget({ job }: Row): void {
    forgetJob(job.id);
    this.list();
    byId("tab-jobs").focus();
  }

  private async tried(act: () => Promise<string>): Promise<void> {
    try {
      this.note.textContent = await act();
    } catch (error) {
      this.note.textContent = textOf(error);
    }
  }
}

function textOf(error: unknown): string {
  return sentence(error instanceof ServiceProblem ? error.problem.detail : String(error));
}
