/** Measurements of a ruler on the surface. */
import type { Vec } from "../../server/protocol";
import { length, minus } from "../../contact/vectors";

/** A surface that returns its height; metres, NaN outside. */
export interface Surface {
  height(x: number, y: number): number;
}

export interface Measurement {
  straightM: number;
  horizontalM: number;
  /** Length along the surface. */
  surfaceM: number;
  /** Height of the end above the start. */
  riseM: number;
  /** Slope of the straight line, radians; 0 if both ends are equal. */
  slope: number;
  /** Heights at even steps from start to end. */
  heightsM: Float64Array;
}

const MAX_STEPS = 8192;
/** Steps per cell, so that corners between cells are not missed. */
const A_CELL = 8;

/** Measure between two places. cellM: size of the surface's cells. */
export function measure(surface: Surface, from: Vec, to: Vec, cellM: number): Measurement {
  const horizontalM = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const steps = Math.min(MAX_STEPS, Math.max(2, Math.ceil((A_CELL * horizontalM) / cellM)));
  const heightsM = new Float64Array(steps + 1);
  let surfaceM = 0;
  for (let i = 0; i <= steps; i++) {
    const share = i / steps;
    heightsM[i] = surface.height(from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]));
    if (i) surfaceM += Math.hypot(horizontalM / steps, heightsM[i] - heightsM[i - 1]);
  }
  const riseM = to[2] - from[2];
  const slope = horizontalM || riseM ? Math.atan2(riseM, horizontalM) : 0;
  return { straightM: length(minus(to, from)), horizontalM, surfaceM, riseM, slope, heightsM };
}
