import { byId } from "./dom.ts";

/** Asks for an API key until there is one; what is typed stays in memory. */
export function askForKey(wasWrong: boolean): Promise<string> {
  const dialog = byId<HTMLDialogElement>("key-dialog");
  const input = byId<HTMLInputElement>("key");
  byId("key-wrong").textContent = wasWrong ? "The service does not know this key." : "";
  byId("key-wrong").hidden = !wasWrong;
  input.value = "";
  if (!dialog.open) dialog.showModal();
  return new Promise((resolve) => {
    byId("key-form").addEventListener(
      "submit",
      () => {
        const key = input.value.trim();
        input.value = "";
        resolve(key);
      },
      { once: true },
    );
    // There is nothing to see without one.
    dialog.addEventListener("cancel", (event) => event.preventDefault());
  });
}
