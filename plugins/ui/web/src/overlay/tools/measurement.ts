/** What a ruler on the surface says. */
import type { Vec } from "../../server/protocol";
import { length, minus } from "../../contact/vectors";

/** A surface as it is asked for its height; metres, NaN outside. */
export interface Surface {
  height(x: number, y: number): number;
}

export interface Measured {
  straightM: number;
  horizontalM: number;
  /** As a thread would lie that follows every rise and fall. */
  surfaceM: number;
  /** How much higher the end is. */
  riseM: number;
  /** Of the straight line from end to end, radians; 0 where both are one place. */
  slope: number;
  /** Heights at even steps from the first end to the second. */
  heightsM: Float64Array;
}

const MOST_STEPS = 8192;
/** The surface bends at its cells, wherever they lie along the ruler: so many steps a cell miss little of a corner. */
const A_CELL = 8;

/** Two places measured. cellM: size of the surface's cells. */
export function measure(surface: Surface, from: Vec, to: Vec, cellM: number): Measured {
  const horizontalM = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const steps = Math.min(MOST_STEPS, Math.max(2, Math.ceil((A_CELL * horizontalM) / cellM)));
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
