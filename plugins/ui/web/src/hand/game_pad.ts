/** The game pad: the left stick moves the hand, the right trigger presses; what it feels shakes the pad. */
import type { Hand } from "./hand";

/** Metres per second with a stick all the way out: along, and up or down. */
const MOST_M_PER_S = 0.1;
const RISE_M_PER_S = 0.02;
/** A stick at rest says up to so much. */
export const REST = 0.15;
/** A trigger says no more than this where it is not pressed. */
const TRIGGER_REST = 0.05;
/** The force that shakes as much as allowed, and how much that is. */
const FULL_N = 4;
const MOST_SHAKE = 0.8;
const SHAKE_MS = 120;
const SHAKE_EVERY_MS = 60;
/** By the standard mapping: the lower, right, left and upper one of four, and the right trigger. */
const PUT_DOWN = 0;
const STOP = 1;
const MIDDLE = 2;
const TAKE = 3;
const TRIGGER = 7;
const BUTTONS = [PUT_DOWN, STOP, MIDDLE, TAKE];

export interface PadState {
  axes: readonly number[];
  buttons: readonly { pressed: boolean; value: number }[];
}

export interface PadWay {
  /** Metres per second. */
  x: number;
  y: number;
  z: number;
  /** How far the trigger is pressed, 0 to 1. */
  press: number;
}

/** What sticks and trigger say. */
export function way({ axes, buttons }: PadState): PadWay {
  const [x = 0, y = 0, , z = 0] = axes;
  const trigger = buttons[TRIGGER]?.value ?? 0;
  const far = Math.hypot(x, y);
  const along = far > 0 ? (bent(far) / far) * MOST_M_PER_S : 0;
  return {
    x: x * along,
    y: 0 - y * along,
    z: 0 - Math.sign(z) * bent(Math.abs(z)) * RISE_M_PER_S,
    press: trigger > TRIGGER_REST ? Math.min(1, trigger) : 0,
  };
}

/** Nothing around its rest, then slowly first. */
function bent(out: number): number {
  const share = Math.min(1, Math.max(0, (out - REST) / (1 - REST)));
  return share * share;
}

interface Shaker {
  playEffect(kind: "dual-rumble", how: { duration: number; strongMagnitude: number; weakMagnitude: number }): unknown;
  reset(): unknown;
}

/** Force as shaking: never more than allowed, and still at once when there is none. */
export class Shake {
  private atMs = -Infinity;
  private shaking = false;

  feel(shaker: Shaker, forceN: number, nowMs: number): void {
    const share = Number.isFinite(forceN) ? Math.min(1, Math.max(0, forceN / FULL_N)) * MOST_SHAKE : 0;
    if (share < 0.01) return this.still(shaker);
    if (nowMs - this.atMs < SHAKE_EVERY_MS) return;
    this.atMs = nowMs;
    this.shaking = true;
    void shaker.playEffect("dual-rumble", { duration: SHAKE_MS, strongMagnitude: share, weakMagnitude: share / 2 });
  }

  still(shaker: Shaker): void {
    if (!this.shaking) return;
    this.shaking = false;
    this.atMs = -Infinity;
    void shaker.reset();
  }
}

/** Buttons that went down since the last look. */
export class Presses {
  private before = new Set<number>();

  take({ buttons }: PadState): number[] {
    const now = new Set(BUTTONS.filter((each) => buttons[each]?.pressed));
    const fresh = [...now].filter((each) => !this.before.has(each));
    this.before = now;
    return fresh;
  }
}

export function pad(hand: Hand): void {
  const presses = new Presses();
  const shake = new Shake();
  const acts: Record<number, () => void> = {
    [PUT_DOWN]: () => hand.put("pad", !hand.down),
    [STOP]: () => hand.stop(),
    [MIDDLE]: () => hand.toMiddle("pad"),
    [TAKE]: () => hand.take(),
  };
  let pressing = false;

  function look(seconds: number): void {
    const found = navigator.getGamepads().find((each) => each?.connected && each.mapping === "standard");
    if (!found) return;
    for (const each of presses.take(found)) acts[each]!();
    if (!document.hasFocus()) return rest(found);
    const { x, y, z, press } = way(found);
    if (x || y || z) hand.go("pad", x * seconds, y * seconds, z * seconds);
    if (press) hand.pressShare(press);
    if (press || pressing) hand.put("pad", press > 0);
    pressing = press > 0;
    const shaker = found.vibrationActuator;
    if (shaker) shake.feel(shaker, hand.feltN, performance.now());
  }

  function rest(found: Gamepad): void {
    if (found.vibrationActuator) shake.still(found.vibrationActuator);
  }

  function quiet(): void {
    for (const each of navigator.getGamepads()) if (each) rest(each);
  }

  hand.moves((seconds) => {
    if (hand.pads) look(seconds);
  });
  document.addEventListener("visibilitychange", () => document.hidden && quiet());
  window.addEventListener("blur", quiet);
}
