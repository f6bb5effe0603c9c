import type { RequestState } from "../service/types.ts";
import { byId, h } from "./dom.ts";
import { label, seconds } from "./words.ts";

/** In the order in which a request passes them; "send", "receive" and "draw" are the page's own. */
const kStages = [
  "send",
  "queued",
  "read",
  "weld",
  "regions",
  "patches",
  "loops",
  "essential_vertices",
  "surfaces",
  "triangulation",
  "refinement",
  "assembly",
  "verify",
  "quality",
  "write",
  "receive",
  "draw",
];
/** Shorter runs need no card. */
const kPatienceMs = 120;

/** How far the run is: a bar of the whole run, and all stages. */
export class ProgressCard {
  private readonly card = byId("progress");
  private readonly bar = byId<HTMLProgressElement>("progress-bar");
  private readonly items = new Map(kStages.map((stage) => [stage, h("li", {}, label(stage))]));
  private started = 0;
  private timer = 0;
  private stage = "";
  private left = "";

  constructor(
    onCancel: () => void,
    private readonly announce: (text: string) => void,
  ) {
    byId("stages").replaceChildren(...this.items.values());
    byId("cancel").addEventListener("click", onCancel);
  }

  start(): void {
    this.started = performance.now();
    this.enter("send", null);
    clearInterval(this.timer);
    this.timer = window.setInterval(() => this.tick(), 100);
  }
  show({ stage, fraction, left_s }: RequestState): void {
    this.enter(stage, fraction === 0 ? null : fraction);
    this.left = left_s === null ? "" : `, about ${seconds(1000 * left_s)} left`;
  }
  /** `fraction`: of the whole run; null: not known. */
  enter(stage: string, fraction: number | null): void {
    if (fraction === null) this.bar.removeAttribute("value");
    else this.bar.value = fraction;
    const percent = fraction === null ? "" : ` ${Math.round(fraction * 100)} %`;
    byId("progress-title").textContent = label(stage) + percent;
    if (stage === this.stage) return;
    this.stage = stage;
    if (!this.card.hidden) this.announce(label(stage));
    const at = kStages.indexOf(stage);
    for (const [name, item] of this.items) {
      const here = kStages.indexOf(name);
      item.className = here < at ? "done" : here === at ? "current" : "";
      if (here === at) item.setAttribute("aria-current", "step");
      else item.removeAttribute("aria-current");
    }
  }
  end(): void {
    clearInterval(this.timer);
    this.card.hidden = true;
    this.stage = this.left = "";
  }
  get elapsedMs(): number {
    return performance.now() - this.started;
  }

  private tick(): void {
    if (this.elapsedMs > kPatienceMs) this.card.hidden = false;
    byId("progress-time").textContent = seconds(this.elapsedMs) + this.left;
  }
}
