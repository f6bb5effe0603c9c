// The daemon, as functions.
import type { Capabilities, Problem, RequestState } from "./types.ts";

/** What the daemon refuses, in its words. */
export class ServiceProblem extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail);
  }
  get isCancelled(): boolean {
    return this.problem.code === "cancelled";
  }
}

export interface Post {
  /** Relative, as all paths here are, so that the page works below any path that a proxy gives it. */
  path: "v1/remesh" | "v1/analyze" | "v1/jobs";
  query: [string, string][];
  body: Blob;
}
export interface Watching {
  onSent: (part: number) => void;
  onState: (state: RequestState) => void;
  onReceived: (bytes: number) => void;
}
export interface Running {
  answer: Promise<Blob>;
  cancel: () => void;
  /** Gives it up without a word: the answer never comes, and the service sees that the connection is closed. */
  abandon: () => void;
}

/** Shorter requests are not watched. */
const kWatchMs = 150;

export class ServiceClient {
  /** Held here and nowhere else. */
  private key: string | null = null;

  /** `askForKey` gives a key, or never returns. */
  constructor(private readonly askForKey: (wasWrong: boolean) => Promise<string>) {}

  get hasKey(): boolean {
    return this.key !== null;
  }

  async capabilities(): Promise<Capabilities> {
    return (await (await this.ask("v1/capabilities")).json()) as Capabilities;
  }

  /** A request without a body. What is refused is thrown as a `ServiceProblem`. */
  async ask(path: string, method: "GET" | "DELETE" = "GET"): Promise<Response> {
    const response = await this.send(path, { method });
    if (!response.ok) throw await problemOf(response.status, response.statusText, await response.text());
    return response;
  }

  /** Any request, with the key. All answers are given, but the one that asks for a key. */
  async send(path: string, init: RequestInit & { headers?: Record<string, string> }): Promise<Response> {
    return this.withKey(async () => {
      const response = await fetch(path, { ...init, headers: { ...this.headers(), ...init.headers } }).catch(() => {
        throw unreachable();
      });
      if (response.status === 401) throw await problemOf(401, response.statusText, await response.text());
      return response;
    });
  }

  /** Sends a mesh; cancelling ends `answer` with the problem `cancelled`. */
  post(post: Post, watching: Watching): Running {
    let attempt: Running | null = null;
    let isCancelled = false;
    const answer = this.withKey(() => {
      if (isCancelled) throw cancelled();
      attempt = this.sendMesh(post, watching);
      return attempt.answer;
    });
    return {
      answer,
      cancel: () => {
        isCancelled = true;
        attempt?.cancel();
      },
      abandon: () => {
        isCancelled = true;
        attempt?.abandon();
      },
    };
  }

  private sendMesh({ path, query, body }: Post, watching: Watching): Running {
    const id = crypto
      .getRandomValues(new Uint8Array(16))
      .reduce((text, byte) => text + byte.toString(16).padStart(2, "0"), "");
    const request = new XMLHttpRequest();
    const ended = new AbortController();
    const answer = new Promise<Blob>((resolve, reject) => {
      request.open("POST", `${path}?${new URLSearchParams(query)}`);
      for (const [name, value] of Object.entries(this.headers())) request.setRequestHeader(name, value);
      request.setRequestHeader("Content-Type", "application/octet-stream");
      request.setRequestHeader("X-Request-Id", id);
      request.responseType = "blob";
      request.upload.onprogress = (event) => watching.onSent(event.loaded / Math.max(event.total, 1));
      // The daemon knows a request once it has all of it.
      request.upload.onload = () => void this.watch(id, ended.signal, watching.onState);
      request.onprogress = (event) => watching.onReceived(event.loaded);
      request.onload = async () => {
        const blob = request.response as Blob;
        // 202: a job was accepted.
        if (request.status === 200 || request.status === 202) resolve(blob);
        else reject(await problemOf(request.status, request.statusText, await blob.text()));
      };
      request.onerror = () => reject(unreachable());
      request.onabort = () => reject(cancelled());
      request.send(body);
    }).finally(() => ended.abort());
    const cancel = async (): Promise<void> => {
      // The daemon answers the request itself; while it is still being sent, nobody there knows it.
      const response = await fetch(`v1/requests/${id}`, { method: "DELETE", headers: this.headers() }).catch(
        () => null,
      );
      if (response?.status !== 204 && !ended.signal.aborted) request.abort();
    };
    return { answer, cancel: () => void cancel(), abandon: () => request.abort() };
  }

  /** Follows the stream of a request's progress. */
  private async watch(id: string, signal: AbortSignal, onState: Watching["onState"]): Promise<void> {
    for (let wait = kWatchMs; ; wait *= 2) {
      await new Promise((resolve) => setTimeout(resolve, wait));
      if (signal.aborted) return;
      try {
        const response = await fetch(`v1/requests/${id}/events`, { headers: this.headers(), signal });
        if (response.ok && response.body) return await readEvents(response.body, signal, onState);
      } catch {
        // Not known yet, or ended with the request: tried again, or not.
      }
    }
  }

  private headers(): Record<string, string> {
    return this.key === null ? {} : { Authorization: `Bearer ${this.key}` };
  }

  private async withKey<T>(ask: () => Promise<T>): Promise<T> {
    for (;;) {
      try {
        return await ask();
      } catch (error) {
        if (!(error instanceof ServiceProblem) || error.problem.status !== 401) throw error;
        this.key = await this.askForKey(this.key !== null);
      }
    }
  }
}

/** Server-sent events: `data: {...}` lines, an empty line between. */
async function readEvents(
  stream: ReadableStream<Uint8Array>,
  signal: AbortSignal,
  onState: Watching["onState"],
): Promise<void> {
  const reader = stream.getReader();
  const decoder = new TextDecoder();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done || signal.aborted) return;
    text += decoder.decode(value, { stream: true });
    const events = text.split("\n\n");
    text = events.pop() ?? "";
    for (const event of events) {
      const data = /^data: (.*)$/m.exec(event)?.[1];
      if (data) onState(JSON.parse(data) as RequestState);
    }
  }
}

async function problemOf(status: number, title: string, body: string): Promise<ServiceProblem> {
  try {
    const problem = JSON.parse(body) as Problem;
    if (typeof problem.detail === "string") return new ServiceProblem(problem);
  } catch {
    // Not from the daemon: a proxy's page, perhaps.
  }
  return new ServiceProblem({ status, title, code: "unknown", detail: `The service answered with status ${status}.` });
}

function unreachable(): ServiceProblem {
  const detail = "The service cannot be reached, or has closed the connection.";
  return new ServiceProblem({ status: 0, title: "No answer", code: "unreachable", detail });
}
function cancelled(): ServiceProblem {
  return new ServiceProblem({
    status: 499,
    title: "Cancelled",
    code: "cancelled",
    detail: "cancelled before it was sent",
  });
}
