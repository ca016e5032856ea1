/** The keyboard: arrows and page keys move the hand, a tap by a step, held by a speed; space puts it down and lifts it. */
import type { Hand } from "./hand";

/** A step and a speed, metres of the hand: alone, with Shift, with Ctrl. */
export const PACES = {
  plain: { stepM: 0.001, mPerS: 0.04 },
  fine: { stepM: 0.0002, mPerS: 0.008 },
  coarse: { stepM: 0.005, mPerS: 0.16 },
} as const;
/** Up and down it goes with this share of that. */
const UPRIGHT = 0.2;
/** A key that is down for longer is held. */
export const HELD_MS = 200;

type Way = readonly [x: number, y: number, z: number];
const WAYS: Record<string, Way> = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, UPRIGHT],
  PageDown: [0, 0, -UPRIGHT],
};

/** What keys that are down say of the hand's way; key repeat says nothing. */
export class HeldKeys {
  private since = new Map<string, number>();
  private pace: keyof typeof PACES = "plain";

  /** The step of a key that went down, metres; null if it is none of the hand's. */
  down(key: string, held: { shiftKey: boolean; ctrlKey: boolean }, nowMs: number): Way | null {
    this.paced(held);
    const way = WAYS[key];
    if (!way) return null;
    if (this.since.has(key)) return [0, 0, 0];
    this.since.set(key, nowMs);
    return scaled(way, PACES[this.pace].stepM);
  }

  up(key: string, held: { shiftKey: boolean; ctrlKey: boolean }): void {
    this.paced(held);
    this.since.delete(key);
  }

  clear(): void {
    this.since.clear();
  }

  /** How far the held ones move the hand in so many seconds up to now, metres. */
  way(seconds: number, nowMs: number): Way {
    const held = [...this.since].filter(([, sinceMs]) => nowMs - sinceMs >= HELD_MS).map(([key]) => WAYS[key]!);
    const sum = [0, 1, 2].map((axis) => held.reduce((total, way) => total + way[axis]!, 0));
    const far = Math.hypot(sum[0]!, sum[1]!);
    const level = far > 1 ? 1 / far : 1; // two at once are no faster than one
    return scaled([sum[0]! * level, sum[1]! * level, sum[2]!], PACES[this.pace].mPerS * seconds);
  }

  private paced({ shiftKey, ctrlKey }: { shiftKey: boolean; ctrlKey: boolean }): void {
    this.pace = shiftKey ? "fine" : ctrlKey ? "coarse" : "plain";
  }
}

export function keys(hand: Hand): void {
  const held = new HeldKeys();
  const { canvas } = hand.page;
  canvas.addEventListener("keydown", (event) => {
    if (event.altKey || event.metaKey) return;
    const step = held.down(event.key, event, performance.now());
    if (step) hand.go("keys", ...step);
    else if (!act(hand, event)) return;
    event.preventDefault();
  });
  canvas.ownerDocument.addEventListener("keyup", (event) => held.up(event.key, event));
  canvas.addEventListener("blur", () => held.clear());
  window.addEventListener("blur", () => held.clear());
  hand.moves((seconds) => {
    const way = held.way(seconds, performance.now());
    if (way.some((part) => part !== 0)) hand.go("keys", ...way);
  });
}

/** Whether the key is one of the hand's. */
function act(hand: Hand, { key, shiftKey, ctrlKey, repeat }: KeyboardEvent): boolean {
  if (ctrlKey) return false;
  if (key === " ") {
    if (!repeat) hand.put("keys", !hand.down);
  } else if (key === "Home") hand.toMiddle("keys");
  else if (key.toLowerCase() === "n") hand.toNextPart("keys", shiftKey ? -1 : 1);
  else if (key === "f") hand.free(!hand.isFree);
  else return false;
  return true;
}

function scaled([x, y, z]: Way, by: number): Way {
  return [x * by, y * by, z * by];
}
