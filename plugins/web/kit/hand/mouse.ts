/** Mouse and pen: over the terrain they move the hand, pressed they touch; wheel and pen pressure set the depth. */
import { figures, measuring } from "../instrumentation";
import type { Page } from "../page";
import type { Hand } from "./hand";
import type { Vec } from "../server/protocol";

/** Depth per unit of the wheel, metres; a notch has a hundred. */
const WHEEL_M = 2e-6;
const LINE = 16;
/** Milliseconds after a key in which an unpressed mouse is ignored: it may have been moved by accident. */
const AFTER_KEYS_MS = 1000;
/** Bits of the camera's buttons. */
const CAMERA = 6;

type Screen = Pick<Page, "canvas" | "view" | "scene">;

export function attachMouse(hand: Hand, page: Screen): void {
  const { canvas, view } = page;
  let before: PointerEvent | null = null;

  function follow(event: PointerEvent): void {
    if (event.pointerType === "touch" || event.buttons & CAMERA || event.altKey) return;
    const down = (event.buttons & 1) === 1 && event.type !== "pointerup";
    if (!down && !hand.down && performance.now() - hand.keyedMs < AFTER_KEYS_MS) return;
    if (event.type === "pointerdown") canvas.setPointerCapture(event.pointerId);
    if (hand.isFree) inSpace(event);
    else onSurface(event, down);
    before = event;
  }

  function onSurface(event: PointerEvent, down: boolean): void {
    const at = pick(event.clientX, event.clientY);
    if (!at) return;
    if (event.pointerType === "pen" && down) hand.pressShare(event.pressure);
    hand.moveOver("mouse", at[0], at[1], down);
  }

  /** Move in the hand's level, and with Shift up and down. */
  function inSpace(event: PointerEvent): void {
    const { at } = hand;
    if (!at) {
      const first = pick(event.clientX, event.clientY);
      if (first) hand.moveTo("mouse", first);
    } else if (event.shiftKey) {
      if (before) hand.moveTo("mouse", [at[0], at[1], hand.goalM(2) - (event.clientY - before.clientY) * metresPerPixel(at)]);
    } else {
      const hit = meetLevel(...view.ray(event.clientX, event.clientY), hand.goalM(2));
      if (hit) hand.moveTo("mouse", hit);
    }
  }

  function metresPerPixel(at: Vec): number {
    const { camera } = view;
    const far = Math.hypot(camera.position.x - at[0], camera.position.y - at[1], camera.position.z - at[2]);
    return (2 * far * Math.tan((camera.fov * Math.PI) / 360)) / Math.max(1, canvas.clientHeight);
  }

  function pick(x: number, y: number): Vec | null {
    const begun = performance.now();
    const place = page.scene?.pick(...view.ray(x, y)) ?? null;
    if (measuring) figures.picks.push(performance.now() - begun);
    return place;
  }

  for (const type of ["pointermove", "pointerdown", "pointerup"] as const) canvas.addEventListener(type, follow);
  for (const type of ["pointerleave", "pointercancel"] as const)
    canvas.addEventListener(type, (event) => {
      before = null;
      if (event.pointerType !== "touch") hand.release("mouse");
    });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => wheel(hand, page, event), { passive: false });
}

function wheel(hand: Hand, { view }: Screen, event: WheelEvent): void {
  event.preventDefault();
  const by = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE * event.deltaY : event.deltaY;
  if (event.ctrlKey) view.zoom(by < 0 ? 0.1 : -0.1);
  else hand.deeper("mouse", by * WHEEL_M);
}

/** Return where a ray meets the level at this height; null if it does not. */
export function meetLevel(o: Vec, d: Vec, z: number): Vec | null {
  const t = (z - o[2]) / d[2];
  return t > 0 && Number.isFinite(t) ? [o[0] + t * d[0], o[1] + t * d[1], z] : null;
}
