/** The pad: an empty field of the surface's proportions, on which mouse, pen or finger moves the hand, seen from above. */
import type { Hand } from "kit/hand/hand";
import type { Scene } from "kit/surface/scene";

/** Milliseconds after a key in which an unpressed mouse is ignored: it may have been moved by accident. */
const AFTER_KEYS_MS = 1000;

/** Let pointers on the pad move the hand. scene: the surface; null between intervals. */
export function attachPad(hand: Hand, pad: HTMLElement, scene: () => Scene | null): void {
  const follow = (event: PointerEvent): void => {
    const surface = scene();
    if (!surface) return;
    const finger = event.pointerType === "touch";
    const down = event.type !== "pointerup" && (finger || (event.buttons & 1) === 1);
    if (!down && !hand.down && performance.now() - hand.keyedMs < AFTER_KEYS_MS) return;
    if (event.type === "pointerdown") {
      pad.focus();
      pad.setPointerCapture(event.pointerId);
    }
    if (finger && !down) return hand.release("touch");
    const [w, l] = surface.meta.extent_m;
    const box = pad.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width - 0.5) * w;
    const y = (0.5 - (event.clientY - box.top) / box.height) * l;
    const [u, v] = surface.on(x, y);
    hand.moveOver(finger ? "touch" : "mouse", u, v, down);
  };
  for (const type of ["pointermove", "pointerdown", "pointerup"] as const) pad.addEventListener(type, follow);
  for (const type of ["pointerleave", "pointercancel"] as const)
    pad.addEventListener(type, ({ pointerType }) => hand.release(pointerType === "touch" ? "touch" : "mouse"));
  pad.addEventListener("contextmenu", (event) => event.preventDefault());
}
