/** The keyboard: arrows and page keys move the hand, by a step when tapped and at a speed when held; Space presses and lifts. */
import type { Page } from "../page";
import type { Hand } from "./hand";

/** Step and speed, metres of the hand: plain, with Shift, with Ctrl. */
export const PACES = {
  plain: { stepM: 0.001, mPerS: 0.04 },
  fine: { stepM: 0.0002, mPerS: 0.008 },
  coarse: { stepM: 0.005, mPerS: 0.16 },
} as const;
/** Share of the speed up and down. */
const UPRIGHT = 0.2;
/** Milliseconds after which a key counts as held. */
export const HELD_MS = 200;

type Displacement = readonly [x: number, y: number, z: number];
const DIRECTIONS: Record<string, Displacement> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, UPRIGHT],
  PageDown: [0, 0, -UPRIGHT],
};

/** The held keys, and the displacement that they cause; key repeat is ignored. */
export class HeldKeys {
  private since = new Map<string, number>();
  private pace: keyof typeof PACES = "plain";

  /** Return the step of a pressed key, metres; null if it is not the hand's. */
  down(key: string, held: { shiftKey: boolean; ctrlKey: boolean }, nowMs: number): Displacement | null {
    this.setPace(held);
    const displacement = DIRECTIONS[key];
    if (!displacement) return null;
    if (this.since.has(key)) return [0, 0, 0];
    this.since.set(key, nowMs);
    return scale(displacement, PACES[this.pace].stepM);
  }

  up(key: string, held: { shiftKey: boolean; ctrlKey: boolean }): void {
    this.setPace(held);
    this.since.delete(key);
  }

  clear(): void {
    this.since.clear();
  }

  /** Return the displacement by the held keys during some seconds up to now, metres. */
  way(seconds: number, nowMs: number): Displacement {
    const held = [...this.since].filter(([, sinceMs]) => nowMs - sinceMs >= HELD_MS).map(([key]) => DIRECTIONS[key]!);
    const sum = [0, 1, 2].map((axis) => held.reduce((total, way) => total + way[axis]!, 0));
    const far = Math.hypot(sum[0]!, sum[1]!);
    const level = far > 1 ? 1 / far : 1; // two keys at once are not faster than one
    return scale([sum[0]! * level, sum[1]! * level, sum[2]!], PACES[this.pace].mPerS * seconds);
  }

  private setPace({ shiftKey, ctrlKey }: { shiftKey: boolean; ctrlKey: boolean }): void {
    this.pace = shiftKey ? "fine" : ctrlKey ? "coarse" : "plain";
  }
}

export function attachKeyboard(hand: Hand, { canvas }: Pick<Page, "canvas">): void {
  const held = new HeldKeys();
  canvas.addEventListener("keydown", (event) => {
    if (event.altKey || event.metaKey) return;
    const step = held.down(event.key, event, performance.now());
    if (step) hand.moveBy("keys", ...step);
    else if (!act(hand, event)) return;
    event.preventDefault();
  });
  canvas.ownerDocument.addEventListener("keyup", (event) => held.up(event.key, event));
  canvas.addEventListener("blur", () => held.clear());
  window.addEventListener("blur", () => held.clear());
  hand.addMover((seconds) => {
    const way = held.way(seconds, performance.now());
    if (way.some((part) => part !== 0)) hand.moveBy("keys", ...way);
  });
}

/** Act on a key; return whether it is the hand's. */
function act(hand: Hand, { key, shiftKey, ctrlKey, repeat }: KeyboardEvent): boolean {
  if (ctrlKey) return false;
  if (key === " ") {
    if (!repeat) hand.press("keys", !hand.down);
  } else if (key === "Home") hand.toMiddle("keys");
  else if (key.toLowerCase() === "n") hand.toNextPart("keys", shiftKey ? -1 : 1);
  else if (key === "f") hand.free(!hand.isFree);
  else return false;
  return true;
}

function scale([x, y, z]: Displacement, by: number): Displacement {
  return [x * by, y * by, z * by];
}
