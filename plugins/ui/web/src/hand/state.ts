/** The state of this page's hand, as other parts show it. */

export type Mover = "mouse" | "keys" | "touch" | "pad";

export interface HandState {
  /** What moves the hand; null while nothing does. */
  readonly by: Mover | null;
  /** Whether it moves freely in space, and not over the surface. */
  readonly isFree: boolean;
  /** Whether this tab's hand is the active one. */
  readonly holding: boolean;
  /** Whether no tab's hand is active. */
  readonly nobodyHolds: boolean;
  /** Whether the server is connected. */
  readonly there: boolean;
  /** Whether the loop uses another device. */
  readonly rests: boolean;
  /** Whether a game pad is connected. */
  readonly pads: boolean;
}

/** Penetration of a pressing hand, metres. */
export const PRESS_M = { first: 0.0015, least: 0.0002, most: 0.006 };
