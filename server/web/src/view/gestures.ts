// Mouse, fingers and keys of a view.
import { type StandardView, pan, turn, zoom } from "./orbit.ts";
import type { Side, Viewer } from "./viewer.ts";

const kClickPixels = 4;
const kTurnByPixel = 0.008;
const kKeyTurn = 0.12;
const kKeyPan = 0.06;
const kKeyZoom = 1.2;

const kViewKeys: Record<string, StandardView> = {
  1: "front",
  2: "back",
  3: "left",
  4: "right",
  5: "top",
  6: "bottom",
  7: "overview",
};

export interface Picking {
  /** `x` and `y`: where, in the view's pixels. */
  pick(side: Side, triangle: number, x: number, y: number): void;
  clear(): void;
}

/** Drag turns, right or Shift drag moves, the wheel zooms, a click picks; fingers and keys do the same. */
export function listen(element: HTMLElement, side: Side, viewer: Viewer, picking: Picking): void {
  const pointers = new Map<number, { x: number; y: number }>();
  let travelled = 0;
  const pick = (x: number, y: number): void => picking.pick(side, viewer.pick(side, x, y), x, y);

  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  element.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 1) {
      if (travelled < kClickPixels) return;
      const isPan = event.shiftKey || (event.buttons & 6) !== 0;
      viewer.move(side, (orbit) => {
        if (isPan) pan(orbit, -dx / element.clientHeight, dy / element.clientHeight);
        else turn(orbit, dx * kTurnByPixel, dy * kTurnByPixel);
      });
    } else {
      const other = [...pointers].find(([id]) => id !== event.pointerId)![1];
      const span = (p: { x: number; y: number }): number => Math.hypot(p.x - other.x, p.y - other.y);
      const factor = span(last) / Math.max(span({ x: event.clientX, y: event.clientY }), 1);
      viewer.move(side, (orbit) => {
        zoom(orbit, factor);
        pan(orbit, -dx / 2 / element.clientHeight, dy / 2 / element.clientHeight);
      });
    }
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  element.addEventListener("pointerup", (event) => {
    pointers.delete(event.pointerId);
    if (travelled >= kClickPixels || event.button !== 0) return;
    const box = element.getBoundingClientRect();
    pick(event.clientX - box.left, event.clientY - box.top);
  });
  element.addEventListener("pointercancel", (event) => pointers.delete(event.pointerId));
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  element.addEventListener("dblclick", () => viewer.fit(side));
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const box = element.getBoundingClientRect();
      const x = ((event.clientX - box.left) / box.width) * 2 - 1;
      const y = 1 - ((event.clientY - box.top) / box.height) * 2;
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
      const factor = Math.exp(Math.min(Math.max(event.deltaY * lines * 0.0015, -0.5), 0.5));
      viewer.move(side, (orbit) => zoom(orbit, factor, x, y, box.width / box.height));
    },
    { passive: false },
  );

  const arrows: Record<string, [number, number]> = {
    ArrowLeft: [-1, 0],
    ArrowRight: [1, 0],
    ArrowUp: [0, 1],
    ArrowDown: [0, -1],
  };
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const arrow = arrows[event.key];
    if (arrow) {
      viewer.move(side, (orbit) => {
        if (event.shiftKey) pan(orbit, arrow[0] * kKeyPan, arrow[1] * kKeyPan);
        else turn(orbit, arrow[0] * kKeyTurn, arrow[1] * kKeyTurn);
      });
    } else if (event.key === "+" || event.key === "=") {
      viewer.move(side, (orbit) => zoom(orbit, 1 / kKeyZoom));
    } else if (event.key === "-") {
      viewer.move(side, (orbit) => zoom(orbit, kKeyZoom));
    } else if (event.key === "Home" || event.key === "0") {
      viewer.fit(side);
    } else if (event.key in kViewKeys) {
      viewer.look(kViewKeys[event.key]!);
    } else if (event.key === "Enter" || event.key === " ") {
      pick(element.clientWidth / 2, element.clientHeight / 2);
    } else if (event.key === "Escape") {
      picking.clear();
    } else {
      return;
    }
    event.preventDefault();
  });
}
