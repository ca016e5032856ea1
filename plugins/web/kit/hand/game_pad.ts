/** The game pad: the left stick moves the hand, the right trigger presses; forces shake the pad. */
import type { Hand } from "./hand";

/** Speed at full deflection: along, and up or down, metres per second. */
const MAX_M_PER_S = 0.1;
const RISE_M_PER_S = 0.02;
/** Greatest deflection of a stick at rest. */
export const DEAD_ZONE = 0.15;
/** Greatest value of a released trigger. */
const TRIGGER_REST = 0.05;
/** Force of the strongest rumble, and its magnitude. */
const FULL_N = 4;
const MAX_SHAKE = 0.8;
const SHAKE_MS = 120;
const SHAKE_EVERY_MS = 60;
/** Buttons of the standard mapping: the lower, right, left and upper one of four, and the right trigger. */
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

export interface PadMotion {
  /** Velocity, metres per second. */
  x: number;
  y: number;
  z: number;
  /** Deflection of the trigger, 0 to 1. */
  press: number;
}

/** Return velocity and press of sticks and trigger. */
export function readPad({ axes, buttons }: PadState): PadMotion {
  const [x = 0, y = 0, , z = 0] = axes;
  const trigger = buttons[TRIGGER]?.value ?? 0;
  const far = Math.hypot(x, y);
  const along = far > 0 ? (applyDeadZone(far) / far) * MAX_M_PER_S : 0;
  return {
    x: x * along,
    y: 0 - y * along,
    z: 0 - Math.sign(z) * applyDeadZone(Math.abs(z)) * RISE_M_PER_S,
    press: trigger > TRIGGER_REST ? Math.min(1, trigger) : 0,
  };
}

/** Return 0 in the dead zone, then a square curve to 1. */
function applyDeadZone(out: number): number {
  const share = Math.min(1, Math.max(0, (out - DEAD_ZONE) / (1 - DEAD_ZONE)));
  return share * share;
}

interface Shaker {
  playEffect(kind: "dual-rumble", how: { duration: number; strongMagnitude: number; weakMagnitude: number }): unknown;
  reset(): unknown;
}

/** Rumble of a force, limited, and stopped at once when there is none. */
export class Rumble {
  private atMs = -Infinity;
  private shaking = false;

  play(shaker: Shaker, forceN: number, nowMs: number): void {
    const share = Number.isFinite(forceN) ? Math.min(1, Math.max(0, forceN / FULL_N)) * MAX_SHAKE : 0;
    if (share < 0.01) return this.stop(shaker);
    if (nowMs - this.atMs < SHAKE_EVERY_MS) return;
    this.atMs = nowMs;
    this.shaking = true;
    void shaker.playEffect("dual-rumble", { duration: SHAKE_MS, strongMagnitude: share, weakMagnitude: share / 2 });
  }

  stop(shaker: Shaker): void {
    if (!this.shaking) return;
    this.shaking = false;
    this.atMs = -Infinity;
    void shaker.reset();
  }
}

/** The buttons pressed since the last poll. */
export class Presses {
  private before = new Set<number>();

  newPresses({ buttons }: PadState): number[] {
    const now = new Set(BUTTONS.filter((each) => buttons[each]?.pressed));
    const fresh = [...now].filter((each) => !this.before.has(each));
    this.before = now;
    return fresh;
  }
}

export function attachGamePad(hand: Hand): void {
  const presses = new Presses();
  const shake = new Rumble();
  const acts: Record<number, () => void> = {
    [PUT_DOWN]: () => hand.press("pad", !hand.down),
    [STOP]: () => hand.stop(),
    [MIDDLE]: () => hand.toMiddle("pad"),
    [TAKE]: () => hand.take(),
  };
  let pressing = false;

  function look(seconds: number): void {
    const gamepad = navigator.getGamepads().find((each) => each?.connected && each.mapping === "standard");
    if (!gamepad) return;
    for (const each of presses.newPresses(gamepad)) acts[each]!();
    if (!document.hasFocus()) return rest(gamepad);
    const { x, y, z, press } = readPad(gamepad);
    if (x || y || z) hand.moveBy("pad", x * seconds, y * seconds, z * seconds);
    if (press) hand.pressShare(press);
    if (press || pressing) hand.press("pad", press > 0);
    pressing = press > 0;
    const shaker = gamepad.vibrationActuator;
    if (shaker) shake.play(shaker, hand.feltN, performance.now());
  }

  function rest(found: Gamepad): void {
    if (found.vibrationActuator) shake.stop(found.vibrationActuator);
  }

  function quiet(): void {
    for (const each of navigator.getGamepads()) if (each) rest(each);
  }

  hand.addMover((seconds) => {
    if (hand.pads) look(seconds);
  });
  document.addEventListener("visibilitychange", () => document.hidden && quiet());
  window.addEventListener("blur", quiet);
}
