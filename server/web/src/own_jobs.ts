// The jobs that this page has sent, kept in this browser alone: without API keys, an id is the only way to a job.

export interface OwnJob {
  id: string;
  /** The name of the file that was sent. */
  file: string;
  /** Milliseconds since 1970. */
  sent: number;
}

const kName = "remeshd-jobs";
/** The oldest ones go beyond it. */
const kMaxKept = 100;

const isJob = (job: Partial<OwnJob> | null): job is OwnJob =>
  typeof job?.id === "string" &&
  /^[0-9a-f]{32}$/.test(job.id) &&
  typeof job.file === "string" &&
  typeof job.sent === "number";

/** The newest first. A browser that keeps nothing, as in a private window, has none. */
export function ownJobs(): OwnJob[] {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(kName) ?? "[]");
    return Array.isArray(kept) ? kept.filter(isJob) : [];
  } catch {
    return [];
  }
}

function keep(jobs: OwnJob[]): void {
  try {
    if (jobs.length > 0) localStorage.setItem(kName, JSON.stringify(jobs.slice(0, kMaxKept)));
    else localStorage.removeItem(kName);
  } catch {
    // The job runs all the same; its id is in the status.
  }
}

export function keepJob(job: OwnJob): void {
  keep([job, ...ownJobs()]);
}
export function forgetJob(id: string): void {
  keep(ownJobs().filter((job) => job.id !== id));
}
