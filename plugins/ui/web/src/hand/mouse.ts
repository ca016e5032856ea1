/** The mouse and the pen: over the terrain they are the hand, pressed they touch; the wheel is depth, a pen's own too. */
import { figures, measuring } from "../instrumentation";
import type { Hand } from "./hand";
import type { Vec } from "../server/protocol";

/** Metres of depth for a unit of the wheel; a notch has a hundred. */
const WHEEL_M = 2e-6;
const LINE = 16;
/** A mouse that is not pressed is not heard for so long after a key: somebody's sleeve may have moved it. */
const AFTER_KEYS_MS = 1000;
/** Buttons that are the camera's. */
const CAMERA = 6;

export function mouse(hand: Hand): void {
  const { canvas, view } = hand.page;
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
    hand.over("mouse", at[0], at[1], down);
  }

  /** In its own level, and with Shift up and down. */
  function inSpace(event: PointerEvent): void {
    const { at } = hand;
    if (!at) {
      const first = pick(event.clientX, event.clientY);
      if (first) hand.at3("mouse", first);
    } else if (event.shiftKey) {
      if (before) hand.at3("mouse", [at[0], at[1], hand.goalM(2) - (event.clientY - before.clientY) * metresPerPixel(at)]);
    } else {
      const found = level(...view.ray(event.clientX, event.clientY), hand.goalM(2));
      if (found) hand.at3("mouse", found);
    }
  }

  function metresPerPixel(at: Vec): number {
    const { camera } = view;
    const far = Math.hypot(camera.position.x - at[0], camera.position.y - at[1], camera.position.z - at[2]);
    return (2 * far * Math.tan((camera.fov * Math.PI) / 360)) / Math.max(1, canvas.clientHeight);
  }

  function pick(x: number, y: number): Vec | null {
    const begun = performance.now();
    const found = hand.page.scene?.pick(...view.ray(x, y)) ?? null;
    if (measuring) figures.picks.push(performance.now() - begun);
    return found;
  }

  for (const type of ["pointermove", "pointerdown", "pointerup"] as const) canvas.addEventListener(type, follow);
  for (const type of ["pointerleave", "pointercancel"] as const)
    canvas.addEventListener(type, (event) => {
      before = null;
      if (event.pointerType !== "touch") hand.release("mouse");
    });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => wheel(hand, event), { passive: false });
}

function wheel(hand: Hand, event: WheelEvent): void {
  event.preventDefault();
  const by = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? LINE * event.deltaY : event.deltaY;
  if (event.ctrlKey) hand.page.view.zoom(by < 0 ? 0.1 : -0.1);
  else hand.deeper("mouse", by * WHEEL_M);
}

/** Where a ray meets the level at this height, if it does before it. */
export function level(o: Vec, d: Vec, z: number): Vec | null {
  const t = (z - o[2]) / d[2];
  return t > 0 && Number.isFinite(t) ? [o[0] + t * d[0], o[1] + t * d[1], z] : null;
}
