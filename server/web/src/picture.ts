// The views as a picture to keep.
import type { Viewer } from "./view/viewer.ts";

export interface Caption {
  side: "before" | "after";
  text: string;
}

/** Output: a PNG of both views, with a line of text over each. */
export function pictureOf(viewer: Viewer, captions: readonly Caption[]): Promise<Blob> {
  const shown = viewer.snapshot();
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [shown.width, shown.height];
  const context = copy.getContext("2d")!;
  context.drawImage(shown, 0, 0);
  const size = Math.round(14 * (shown.width / Math.max(shown.clientWidth, 1)));
  context.font = `600 ${size}px system-ui, sans-serif`;
  context.textBaseline = "top";
  context.fillStyle = getComputedStyle(document.body).color;
  for (const { side, text } of captions) {
    const area = viewer.areaOf(side);
    context.fillText(text, area.x + size, area.y + size);
  }
  return new Promise((resolve, reject) => {
    copy.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The browser made no picture."))), "image/png");
  });
}
