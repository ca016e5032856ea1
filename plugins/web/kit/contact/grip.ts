/** State of the contact, sticking or slipping, from its motion along the surface and the tangential part of the force.
 *
 * The contact is the proxy where the law has one, else the surface above the hand. Its speed along the surface is taken
 * between two states and smoothed over SMOOTH_S. It counts as moving above MOVES_M_PER_S and until it is below
 * RESTS_M_PER_S again. Then, with the force's normal part N and its tangential part T:
 *
 * - moving, and T opposes the motion with at least half of dynamic friction times N: it slips;
 * - moving otherwise: it glides, as there is no friction to speak of;
 * - at rest, and T is over HELD_SHARE of N: it sticks, as friction holds what pulls at it;
 * - at rest otherwise: it rests, as nothing pulls at it. */
import type { Vec } from "../server/protocol";
import { tangential, dot, length, minus } from "./vectors";

export const GRIPS = ["apart", "rests", "sticks", "slips", "glides"] as const;
export type Grip = (typeof GRIPS)[number];

export const MOVES_M_PER_S = 0.003;
export const RESTS_M_PER_S = 0.0015;
export const SMOOTH_S = 0.05;
export const HELD_SHARE = 0.05;
const MIN_N = 0.02;
/** Longest time between two states from which a speed is taken. */
const LONGEST_S = 0.25;

/** A state as input of the rule. */
export interface ContactSample {
  touching: boolean;
  atMs: number;
  contact: Vec;
  normal: Vec;
  force: Vec;
  dynamicFriction: number;
}

/** The rule that follows a contact from state to state. */
export class GripRule {
  grip: Grip = "apart";
  /** Speed along the surface. */
  speedMPerS = 0;
  private velocity: Vec = [0, 0, 0];
  private before: ContactSample | null = null;
  private moving = false;

  update(held: ContactSample): Grip {
    const normalN = dot(held.force, held.normal);
    if (!held.touching || !(normalN > MIN_N)) return this.reset();
    this.move(held);
    this.before = held;
    const pull = tangential(held.force, held.normal);
    if (!this.moving) return (this.grip = length(pull) > HELD_SHARE * normalN ? "sticks" : "rests");
    const opposing = -dot(pull, this.velocity) / (this.speedMPerS || 1);
    const friction = 0.5 * held.dynamicFriction * normalN;
    return (this.grip = friction > 0 && opposing >= friction ? "slips" : "glides");
  }

  private reset(): Grip {
    this.before = null;
    this.moving = false;
    this.velocity = [0, 0, 0];
    this.speedMPerS = 0;
    return (this.grip = "apart");
  }

  private move(held: ContactSample): void {
    const passedS = this.before ? (held.atMs - this.before.atMs) / 1000 : 0;
    if (!this.before || passedS <= 0 || passedS > LONGEST_S) return;
    const way = tangential(minus(held.contact, this.before.contact), held.normal);
    const share = 1 - Math.exp(-passedS / SMOOTH_S);
    for (const axis of [0, 1, 2]) this.velocity[axis] += share * (way[axis] / passedS - this.velocity[axis]);
    this.speedMPerS = length(this.velocity);
    this.moving = this.speedMPerS > (this.moving ? RESTS_M_PER_S : MOVES_M_PER_S);
  }
}
