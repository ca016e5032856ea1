/** Limits of the guard by the bits of a state's flags; docs/explanation/safety.md explains each. */
import { FLAGS } from "../server/protocol";

export const LIMITS = [
  { bit: FLAGS.FORCE_LIMITED, name: "FORCE_LIMITED", word: "forceLimited" },
  { bit: FLAGS.SLEW_LIMITED, name: "SLEW_LIMITED", word: "slewLimited" },
  { bit: FLAGS.STIFFNESS_LIMITED, name: "STIFFNESS_LIMITED", word: "softened" },
  { bit: FLAGS.DAMPED, name: "DAMPED", word: "damped" },
  { bit: FLAGS.RAMPING, name: "RAMPING", word: "fadingIn" },
  { bit: FLAGS.STALE, name: "STALE", word: "stale" },
  { bit: FLAGS.NOT_FINITE, name: "NOT_FINITE", word: "notFinite" },
  { bit: FLAGS.OVERRUN, name: "OVERRUN", word: "overrun" },
] as const;

const ANY = LIMITS.reduce((sum, { bit }) => sum | bit, 0);

export const isLimited = (flags: number): boolean => (flags & ANY) !== 0;

/** Counts of the loop since its start: ticks, and ticks with each flag. */
export interface Counts {
  ticks: number;
  overruns: number;
  flagged: Record<string, number>;
}

/** Return each limit's rate per second between two counts; null if the loop was restarted or stood still. */
export function perSecond(before: Counts, after: Counts, passedS: number): number[] | null {
  if (!(passedS > 0) || after.ticks <= before.ticks) return null;
  const of = (counts: Counts, name: string): number => (name === "OVERRUN" ? counts.overruns : (counts.flagged[name] ?? 0));
  return LIMITS.map(({ name }) => Math.max(0, of(after, name) - of(before, name)) / passedS);
}
