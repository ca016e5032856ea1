/** The mouse: over the terrain it is the hand, pressed it touches, the wheel presses deeper. */
import { figures } from "../frames";
import type { Hand } from "../hand";
import type { Vec } from "../protocol";

/** Metres of depth for a unit of the wheel. */
const WHEEL_M = 2e-6;
const OTHER_BUTTONS = 6;

export function mouse(hand: Hand): void {
  const { canvas, view } = hand.page;

  function follow(event: PointerEvent): void {
    if (event.buttons & OTHER_BUTTONS || event.altKey) return; // the camera's
    const at = pick(event.clientX, event.clientY);
    if (at) hand.move(at, (event.buttons & 1) === 1 && event.type !== "pointerup");
  }

  function pick(x: number, y: number): Vec | null {
    const begun = performance.now();
    const found = hand.page.scene?.pick(...view.ray(x, y)) ?? null;
    figures.picks.push(performance.now() - begun);
    return found;
  }

  for (const type of ["pointermove", "pointerdown", "pointerup"] as const) canvas.addEventListener(type, follow);
  canvas.addEventListener("pointerleave", () => hand.release());
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      if (event.ctrlKey) view.zoom(event.deltaY < 0 ? 0.1 : -0.1);
      else hand.press(event.deltaY * WHEEL_M);
    },
    { passive: false },
  );
}
