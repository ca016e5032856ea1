/** Motion of the hand to its goal: never faster than a hand, through a wall, or deeper than it presses. */
import type { Vec } from "../server/protocol";

/** Speeds of a hand, metres per second: along the surface, up, down; and freely in space. */
export const SPEED = { moveOverSurface: 1.0, climb: 0.25, sink: 0.5, free: 0.25 };
/** Height at which a hand starts over the surface. */
export const HOVER_M = 0.002;
/** Limits of a hand in space around and above the surface, and below its lowest place. */
const BESIDE_M = 0.02;
const ABOVE_M = 0.05;
const BELOW_M = 0.01;
/** Rounding allowed in the depth of a step. */
const SLACK_M = 1e-6;
const MAX_STEPS = 2000;

/** The surface under the hand. */
export interface Ground {
  readonly meta: { readonly extent_m: [number, number]; readonly height_m: [number, number]; readonly columns: number };
  height(x: number, y: number): number;
}

/** Goal of the hand: a height over a place of the surface, below 0 in it; or a place in space. */
export type Goal = { over: [number, number]; gapM: number } | { at: Vec };

/** Clamp a place to the rim: the outermost half cell has no neighbour, and beyond it there is no surface. */
export function clampToRim(ground: Ground, x: number, y: number): [number, number] {
  const [w, l] = ground.meta.extent_m;
  const rim = Math.min(pitch(ground) / 2, w / 4, l / 4);
  return [clamp(x, rim - w / 2, w / 2 - rim), clamp(y, rim - l / 2, l / 2 - rim)];
}

/** Return the position after `seconds`; the first one is over the surface. slower: magnification of the region. */
export function nextPosition(from: Vec | null, goal: Goal, seconds: number, ground: Ground, slower = 1): Vec {
  if ("at" in goal) return moveInSpace(from ?? startAbove(ground, goal.at[0], goal.at[1], slower), goal.at, seconds, ground, slower);
  const [x, y] = clampToRim(ground, ...goal.over);
  return along(from ?? startAbove(ground, x, y, slower), x, y, goal.gapM, seconds, ground, slower);
}

/** Move in a straight line. */
function moveInSpace(from: Vec, to: Vec, seconds: number, ground: Ground, slower: number): Vec {
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

/** Move over the ground in steps of half a cell: at a rise that is too fast the hand waits and climbs. */
function along(
  from: Vec, goalX: number, goalY: number, gapM: number, seconds: number, ground: Ground, slower: number,
): Vec {
  let [x, y, z] = from;
  const [dx, dy] = [goalX - x, goalY - y];
  const far = Math.hypot(dx, dy);
  const reach = Math.min(far, (SPEED.moveOverSurface * seconds) / slower);
  const steps = clamp(Math.ceil(reach / (pitch(ground) / 2)), 1, MAX_STEPS);
  const [up, down] = [(SPEED.climb * seconds) / slower / steps, (SPEED.sink * seconds) / slower / steps];
  const [stepX, stepY] = far > 0 ? [(dx / far) * (reach / steps), (dy / far) * (reach / steps)] : [0, 0];
  for (let i = 0; i < steps; i++) {
    const there = ground.height(x + stepX, y + stepY);
    z += clamp(there + gapM - z, -down, up);
    if (z < there + Math.min(gapM, 0) - SLACK_M) continue; // a wall: the hand climbs in place
    x += stepX;
    y += stepY;
  }
  return [x, y, z];
}

function startAbove(ground: Ground, x: number, y: number, slower: number): Vec {
  const [u, v] = clampToRim(ground, x, y);
  return [u, v, ground.height(u, v) + HOVER_M / slower];
}

function pitch(ground: Ground): number {
  return ground.meta.extent_m[0] / Math.max(1, ground.meta.columns);
}

export function clamp(part: number, low: number, high: number): number {
  return Math.min(high, Math.max(low, part));
}
