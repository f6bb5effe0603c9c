import type { Remedy } from "../service/types.ts";
import { adviceList } from "./advice.ts";
import { byId } from "./dom.ts";
import { count, whole } from "./words.ts";

/** A remeshing that is expected to have more faces than this is asked about first. */
export const kLargeResult = 300_000;

/** What came of the question: the run, nothing, or options that are to be set instead. */
export type Answer = "run" | "back" | { options: string };

/**
 * Shows how many faces are expected and how many the service makes at most, and asks whether to go on. Beyond that limit
 * there is no going on, but only options that ask for less.
 */
export function askAboutLarge(predicted: number, limit: number, remedies: readonly Remedy[]): Promise<Answer> {
  const dialog = byId<HTMLDialogElement>("large-dialog");
  const isTooLarge = predicted > limit;
  byId("large-title").textContent = isTooLarge ? "This service cannot make so many faces" : "This makes many faces";
  byId("large-text").textContent =
    `With these options, about ${count(predicted, "face")} are expected. ` +
    (Number.isFinite(limit) ? `This service makes at most ${whole(limit)}. ` : "") +
    (isTooLarge ? "Ask for larger edges, or for a number of faces." : "That may take long, and make the page slow.");
  byId("large-run").hidden = isTooLarge;
  const fewer = Number((Math.min(kLargeResult, limit) / 3).toPrecision(1));
  const advice = [{ options: `target_faces=${fewer}`, effect: "is drawn without delay" }, ...remedies];
  return new Promise((resolve) => {
    let chosen: Answer | null = null;
    byId("large-advice").replaceChildren(
      adviceList(advice, (options) => {
        chosen = { options };
        dialog.close();
      }),
    );
    dialog.returnValue = "";
    dialog.addEventListener("close", () => resolve(chosen ?? (dialog.returnValue === "run" ? "run" : "back")), {
      once: true,
    });
    dialog.showModal();
    byId(isTooLarge ? "large-back" : "large-run").focus();
  });
}
