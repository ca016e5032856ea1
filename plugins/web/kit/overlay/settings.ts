/** Settings of the overlay: what is shown, and how large. */

export const SWITCHES = ["device", "proxy", "ring", "arrow", "cone", "trace", "labels", "limits", "markers"] as const;
export type Switch = (typeof SWITCHES)[number];

export interface Settings {
  show: Record<Switch, boolean>;
  /** Length of the trace. */
  seconds: number;
  /** Length of the force arrow, metres per newton. */
  metresPerNewton: number;
}

export const SECONDS = { least: 1, first: 5, most: 30 } as const;
export const MM_PER_N = { least: 0.1, most: 100 } as const;

export function settings(): Settings {
  return {
    show: Object.fromEntries(SWITCHES.map((each) => [each, true])) as Record<Switch, boolean>,
    seconds: SECONDS.first,
    metresPerNewton: 0.005,
  };
}

/** Return the greatest 1, 2 or 5 times a power of ten that is not above a value. */
export function roundDown125(value: number): number {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  const digit = value / power + 1e-9;
  return Number(((digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power).toPrecision(1));
}
