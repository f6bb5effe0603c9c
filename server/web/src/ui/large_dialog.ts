import { byId } from "./dom.ts";
import { count } from "./words.ts";

/** A remeshing that is expected to have more faces than this is asked about first. */
export const kLargeResult = 300_000;

/** Shows how many faces are expected, and asks whether to go on. */
export function askAboutLarge(predicted: number): Promise<boolean> {
  const dialog = byId<HTMLDialogElement>("large-dialog");
  byId("large-text").textContent =
    `With these options, about ${count(predicted, "face")} are expected. That may take long, and make the page slow.`;
  dialog.returnValue = "";
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "run"), { once: true });
  });
}
