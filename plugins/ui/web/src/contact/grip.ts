/**
 * Whether the contact sticks or slips, from what can be seen of it: how it moves along the surface, and how much of the
 * force is tangential.
 *
 * The contact is the proxy where the law has one, else the surface above the hand. Its speed along the surface is taken
 * between two states and smoothed over SMOOTH_S. It counts as moving above MOVES_M_PER_S and until it is below
 * RESTS_M_PER_S again. Then, with the force's normal part N and its tangential part T:
 *
 * - moving, and T opposes the motion with at least half of dynamic friction times N: it slips;
 * - moving otherwise: it glides, as there is no friction to speak of;
 * - at rest, and T is over HELD_SHARE of N: it sticks, as friction holds what pulls at it;
 * - at rest otherwise: it rests, as nothing pulls at it.
 */
import type { Vec } from "../server/protocol";
import { across, dot, length, minus } from "./vectors";

export const GRIPS = ["apart", "rests", "sticks", "slips", "glides"] as const;
export type Grip = (typeof GRIPS)[number];

export const MOVES_M_PER_S = 0.003;
export const RESTS_M_PER_S = 0.0015;
export const SMOOTH_S = 0.05;
export const HELD_SHARE = 0.05;
const LEAST_N = 0.02;
/** States farther apart say nothing of a speed. */
const LONGEST_S = 0.25;

/** One state, as the rule needs it. */
export interface Held {
  touching: boolean;
  atMs: number;
  contact: Vec;
  normal: Vec;
  force: Vec;
  dynamicFriction: number;
}

/** Follows a contact from state to state. */
export class GripRule {
  grip: Grip = "apart";
  /** Along the surface. */
  speedMPerS = 0;
  private velocity: Vec = [0, 0, 0];
  private before: Held | null = null;
  private moving = false;

  next(held: Held): Grip {
    const normalN = dot(held.force, held.normal);
    if (!held.touching || !(normalN > LEAST_N)) return this.leave();
    this.move(held);
    this.before = held;
    const tangential = across(held.force, held.normal);
    if (!this.moving) return (this.grip = length(tangential) > HELD_SHARE * normalN ? "sticks" : "rests");
    const opposing = -dot(tangential, this.velocity) / (this.speedMPerS || 1);
    const friction = 0.5 * held.dynamicFriction * normalN;
    return (this.grip = friction > 0 && opposing >= friction ? "slips" : "glides");
  }

  private leave(): Grip {
    this.before = null;
    this.moving = false;
    this.velocity = [0, 0, 0];
    this.speedMPerS = 0;
    return (this.grip = "apart");
  }

  private move(held: Held): void {
    const passedS = this.before ? (held.atMs - this.before.atMs) / 1000 : 0;
    if (!this.before || passedS <= 0 || passedS > LONGEST_S) return;
    const way = across(minus(held.contact, this.before.contact), held.normal);
    const share = 1 - Math.exp(-passedS / SMOOTH_S);
    for (const axis of [0, 1, 2]) this.velocity[axis] += share * (way[axis] / passedS - this.velocity[axis]);
    this.speedMPerS = length(this.velocity);
    this.moving = this.speedMPerS > (this.moving ? RESTS_M_PER_S : MOVES_M_PER_S);
  }
}
