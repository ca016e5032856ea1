/** The state of this page's hand, as other parts show it. */

export type Mover = "mouse" | "keys" | "touch" | "pad";

export interface HandState {
  /** Mover of the hand; null while it rests. */
  readonly by: Mover | null;
  /** True if it moves freely in space, and not over the surface. */
  readonly isFree: boolean;
  /** True if this tab's hand is the active one. */
  readonly holding: boolean;
  /** True if no tab's hand is active. */
  readonly nobodyHolds: boolean;
  /** True if the server is connected. */
  readonly there: boolean;
  /** True if the loop uses another device. */
  readonly rests: boolean;
  /** True if a game pad is connected. */
  readonly pads: boolean;
}

/** Penetration of a pressing hand, metres. */
export const PRESS_M = { first: 0.0015, least: 0.0002, most: 0.006 };
