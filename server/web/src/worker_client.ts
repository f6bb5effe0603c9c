import type { Deviation } from "./mesh/deviation.ts";
import type { Answered, Opened, Reply, Task } from "./worker.ts";
import { UnreadableMesh } from "./mesh/surface.ts";

/** Set while building. */
declare const WORKER_FILE: string;

/** The second thread, as functions. */
export class WorkerClient {
  private readonly worker = new Worker(WORKER_FILE);
  private readonly waiting = new Map<number, { resolve: (reply: Reply) => void; reject: (error: Error) => void }>();
  private last = 0;

  constructor() {
    this.worker.addEventListener("message", (event: MessageEvent<Reply>) => {
      const reply = event.data;
      const waiting = this.waiting.get(reply.id);
      this.waiting.delete(reply.id);
      if (!waiting) return;
      if ("failure" in reply) waiting.reject(new (reply.isUnreadable ? UnreadableMesh : Error)(reply.failure));
      else waiting.resolve(reply);
    });
    this.worker.addEventListener("error", (event) => {
      for (const { reject } of this.waiting.values()) reject(new Error(event.message || "The page's worker failed."));
      this.waiting.clear();
    });
  }

  /** Errors: UnreadableMesh. */
  async open(file: Blob): Promise<Opened> {
    return ((await this.run({ kind: "open", file })) as Reply & { opened: Opened }).opened;
  }
  async answer(body: Blob): Promise<Answered> {
    return ((await this.run({ kind: "answer", body })) as Reply & { answered: Answered }).answered;
  }
  /** Positions as in drawables. */
  async deviation(before: Float32Array, after: Float32Array): Promise<Deviation> {
    return ((await this.run({ kind: "deviation", before, after })) as Reply & { deviation: Deviation }).deviation;
  }

  private run(task: Task): Promise<Reply> {
    const id = ++this.last;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, task });
    });
  }
}
