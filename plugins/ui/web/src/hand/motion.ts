/** How the hand gets to where it is wanted: never faster than a hand, never through a wall, never deeper than it presses. */
import type { Vec } from "../server/protocol";

/** Speeds of a hand, metres per second: along the surface, up, down; and in space, where no surface leads it. */
export const SPEED = { along: 1.0, climb: 0.25, sink: 0.5, free: 0.25 };
/** Over the surface it comes from there, however it was moved to its first place. */
export const HOVER_M = 0.002;
/** So far a hand in space may go beside and above the surface, and below its lowest place. */
const BESIDE_M = 0.02;
const ABOVE_M = 0.05;
const BELOW_M = 0.01;
/** What a step may be deeper than it is wanted: rounding, no more. */
const SLACK_M = 1e-6;
const MOST_STEPS = 2000;

/** The surface under the hand. */
export interface Ground {
  readonly meta: { readonly extent_m: [number, number]; readonly height_m: [number, number]; readonly columns: number };
  height(x: number, y: number): number;
}

/** Where the hand is wanted: so high over the surface, below 0 in it; or at a place in space. */
export type Goal = { over: [number, number]; gapM: number } | { at: Vec };

/** Within the rim: the outermost half cell has no neighbour to lean on, and a place beside it is a fall. */
export function within(ground: Ground, x: number, y: number): [number, number] {
  const [w, l] = ground.meta.extent_m;
  const rim = Math.min(pitch(ground) / 2, w / 4, l / 4);
  return [clamp(x, rim - w / 2, w / 2 - rim), clamp(y, rim - l / 2, l / 2 - rim)];
}

/** The place after `seconds`; the first one is over the surface. slower: by how much a region is felt enlarged. */
export function moved(from: Vec | null, goal: Goal, seconds: number, ground: Ground, slower = 1): Vec {
  if ("at" in goal) return through(from ?? above(ground, goal.at[0], goal.at[1], slower), goal.at, seconds, ground, slower);
  const [x, y] = within(ground, ...goal.over);
  return along(from ?? above(ground, x, y, slower), x, y, goal.gapM, seconds, ground, slower);
}

/** In a straight line. */
function through(from: Vec, to: Vec, seconds: number, ground: Ground, slower: number): Vec {
  const [w, l] = ground.meta.extent_m;
  const [low, high] = ground.meta.height_m;
  const goal: Vec = [
    clamp(to[0], -w / 2 - BESIDE_M, w / 2 + BESIDE_M),
    clamp(to[1], -l / 2 - BESIDE_M, l / 2 + BESIDE_M),
    clamp(to[2], low - BELOW_M, high + ABOVE_M),
  ];
  const way = goal.map((part, i) => part - from[i]!) as Vec;
  const far = Math.hypot(...way);
  const share = far > 0 ? Math.min(1, (SPEED.free * seconds) / slower / far) : 1;
  return from.map((part, i) => part + share * way[i]!) as Vec;
}

/** Over the ground in steps of half a cell: where the next one rises faster than a hand does, the hand waits, and climbs. */
function along(
  from: Vec, goalX: number, goalY: number, gapM: number, seconds: number, ground: Ground, slower: number,
): Vec {
  let [x, y, z] = from;
  const [dx, dy] = [goalX - x, goalY - y];
  const far = Math.hypot(dx, dy);
  const reach = Math.min(far, (SPEED.along * seconds) / slower);
  const steps = clamp(Math.ceil(reach / (pitch(ground) / 2)), 1, MOST_STEPS);
  const [up, down] = [(SPEED.climb * seconds) / slower / steps, (SPEED.sink * seconds) / slower / steps];
  const [stepX, stepY] = far > 0 ? [(dx / far) * (reach / steps), (dy / far) * (reach / steps)] : [0, 0];
  for (let i = 0; i < steps; i++) {
    const there = ground.height(x + stepX, y + stepY);
    z += clamp(there + gapM - z, -down, up);
    if (z < there + Math.min(gapM, 0) - SLACK_M) continue; // a wall: it climbs where it is
    x += stepX;
    y += stepY;
  }
  return [x, y, z];
}

function above(ground: Ground, x: number, y: number, slower: number): Vec {
  const [u, v] = within(ground, x, y);
  return [u, v, ground.height(u, v) + HOVER_M / slower];
}

function pitch(ground: Ground): number {
  return ground.meta.extent_m[0] / Math.max(1, ground.meta.columns);
}

export function clamp(part: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, part));
}
