// What the service expects of a run, asked for while the options are still being set.
import type { Post, Running, Watching } from "./service/client.ts";
import type { Report } from "./service/types.ts";

/** Larger files would make the service work at every stroke of a key; for them, an analysis is asked for. */
const kLargestFile = 4_000_000;
/** Options are set in several strokes. */
const kCalmMs = 350;

export interface Expected {
  file: File;
  query: [string, string][];
  report: Report;
}

const kUnwatched: Watching = { onSent: () => {}, onState: () => {}, onReceived: () => {} };

export class Forecast {
  private timer = 0;
  private running: Running | null = null;
  private last: Expected | null = null;

  /** `onTold` is given null while nothing is known. */
  constructor(
    private readonly post: (post: Post, watching: Watching) => Running,
    private readonly onTold: (expected: Expected | null) => void,
  ) {}

  /** What is known of this file with these options, or null. */
  of(file: File, query: [string, string][]): Expected | null {
    const { last } = this;
    return last && last.file === file && JSON.stringify(last.query) === JSON.stringify(query) ? last : null;
  }

  /** An analysis that was made anyway. */
  learn(expected: Expected): void {
    this.drop();
    this.last = expected;
    this.onTold(expected);
  }

  /** The file or an option has changed. `file`: null where there is nothing to ask about. */
  change(file: File | null, query: [string, string][]): void {
    this.drop();
    const known = file && this.of(file, query);
    this.onTold(known);
    if (!file || known || file.size > kLargestFile) return;
    this.timer = window.setTimeout(() => void this.ask(file, query), kCalmMs);
  }

  /** Forgets the question that is waiting or on its way. */
  drop(): void {
    clearTimeout(this.timer);
    this.running?.abandon();
    this.running = null;
  }

  private async ask(file: File, query: [string, string][]): Promise<void> {
    const running = this.post({ path: "v1/analyze", query, body: file }, kUnwatched);
    this.running = running;
    try {
      const { report } = JSON.parse(await (await running.answer).text()) as { report: Report };
      if (this.running === running) this.learn({ file, query, report });
    } catch {
      // What is wrong with a mesh or an option is told when it is remeshed.
      if (this.running === running) this.running = null;
    }
  }
}
