/** Input of the camera: mouse, fingers, wheel and keys. */
import type { Vec } from "../server/protocol";
import type { Eye } from "./camera";

const KEY_TURN = 0.12;
const KEY_SHARE = 0.06;
const TURN_PER_PIXEL = 0.008;

/** The keys of the camera, as they are pressed on the terrain. */
export const CAMERA_KEYS = [
  { keys: ["Ctrl", "Shift", "← → ↑ ↓"], does: "orbit" },
  { keys: ["Alt", "← → ↑ ↓"], does: "pan" },
  { keys: ["+", "−"], does: "zoom" },
  { keys: ["Ctrl", "Home"], does: "home" },
  { keys: ["Ctrl", "End"], does: "top" },
] as const;

const WAYS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

export type CameraAct = (typeof CAMERA_KEYS)[number]["does"];

/** Act on a key of the camera: none that is the hand's (shortcuts.ts). Return what it did, null for another key. */
export function handleKey(eye: Eye, event: KeyboardEvent): CameraAct | null {
  const way = WAYS[event.key];
  const { key, ctrlKey, shiftKey, altKey } = event;
  if (event.metaKey) return null;
  if (way && ctrlKey && shiftKey && !altKey) return eye.orbit(way[0] * KEY_TURN, -way[1] * KEY_TURN), "orbit";
  if (way && altKey && !ctrlKey && !shiftKey) return eye.pan(way[0] * KEY_SHARE, way[1] * KEY_SHARE), "pan";
  if (altKey) return null;
  if (ctrlKey && key === "Home") return eye.home(), "home";
  if (ctrlKey && key === "End") return eye.top(), "top";
  if (ctrlKey || (key !== "+" && key !== "-")) return null;
  return eye.zoom(key === "+" ? 0.85 : 1 / 0.85), "zoom";
}

/**
 * Mouse, fingers, wheel and keys that are the camera's: they are taken before anything else on the canvas hears of them.
 * One finger and the plain left button are the hand's. When a second finger comes, the first one's hand is let go.
 */
export function attachCameraInput(
  canvas: HTMLCanvasElement, eye: Eye, ground: (x: number, y: number) => Vec | null, acted: (act: CameraAct) => void,
): void {
  const fingers = new Map<number, [number, number]>();
  let grip: { pointer: number; orbits: boolean; at: [number, number] } | null = null;
  let pinching = false;

  const take = (event: Event): void => {
    event.preventDefault();
    event.stopImmediatePropagation();
  };

  function down(event: PointerEvent): void {
    if (event.pointerType === "touch") return finger(event);
    const orbits = event.button === 1 || (event.button === 0 && event.altKey);
    const pans = event.button === 2 || (event.button === 0 && event.shiftKey);
    if (!orbits && !pans) return;
    grip = { pointer: event.pointerId, orbits, at: [event.clientX, event.clientY] };
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    take(event);
  }

  function finger(event: PointerEvent): void {
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size < 2) return;
    if (!pinching)
      for (const pointerId of fingers.keys())
        if (pointerId !== event.pointerId) canvas.dispatchEvent(new PointerEvent("pointercancel", { pointerId, pointerType: "touch" }));
    pinching = true;
    take(event);
  }

  function move(event: PointerEvent): void {
    if (fingers.has(event.pointerId)) {
      if (pinching) pinch(event);
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      if (pinching) take(event);
    } else if (grip?.pointer === event.pointerId) {
      const [dx, dy] = [event.clientX - grip.at[0], event.clientY - grip.at[1]];
      grip.at = [event.clientX, event.clientY];
      if (grip.orbits) eye.orbit(-dx * TURN_PER_PIXEL, -dy * TURN_PER_PIXEL);
      else eye.pan(-dx / canvas.clientHeight, dy / canvas.clientHeight);
      take(event);
    }
  }

  /** Two fingers: apart is nearer, turned is turned, together is along. */
  function pinch(event: PointerEvent): void {
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    const was = fingers.get(event.pointerId)!;
    if (!other || fingers.size !== 2) return;
    const is: [number, number] = [event.clientX, event.clientY];
    const [before, after] = [was, is].map(([x, y]) => [x - other[0], y - other[1]]);
    const turn = Math.atan2(after[1], after[0]) - Math.atan2(before[1], before[0]);
    const middle = ground((is[0] + other[0]) / 2, (is[1] + other[1]) / 2);
    eye.zoom(Math.hypot(before[0], before[1]) / Math.max(Math.hypot(after[0], after[1]), 1), middle);
    eye.orbit(Math.atan2(Math.sin(turn), Math.cos(turn)), 0);
    eye.pan(-(is[0] - was[0]) / 2 / canvas.clientHeight, (is[1] - was[1]) / 2 / canvas.clientHeight);
  }

  function up(event: PointerEvent): void {
    if (!event.isTrusted) return; // our own, for the hand
    if (fingers.delete(event.pointerId)) {
      if (pinching) take(event);
      if (!fingers.size) pinching = false;
    } else if (grip?.pointer === event.pointerId) {
      grip = null;
      take(event);
    }
  }

  const first = { capture: true, passive: false };
  canvas.addEventListener("pointerdown", down, first);
  canvas.addEventListener("pointermove", move, first);
  canvas.addEventListener("pointerup", up, first);
  canvas.addEventListener("pointercancel", up, first);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey) return; // the hand's depth
      eye.zoom(Math.exp(Math.min(Math.max(event.deltaY, -60), 60) * 0.004), ground(event.clientX, event.clientY));
      take(event);
    },
    first,
  );
  canvas.addEventListener("keydown", (event) => {
    const act = handleKey(eye, event);
    if (!act) return;
    take(event);
    acted(act);
  }, first);
}
