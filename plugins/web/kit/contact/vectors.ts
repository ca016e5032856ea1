/** Vectors of three numbers. */
import type { Vec } from "../server/protocol";

export const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const minus = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const plus = (a: Vec, b: Vec, times = 1): Vec => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];
export const length = (a: Vec): number => Math.hypot(a[0], a[1], a[2]);

/** Return a vector without its part along a unit vector. */
export const tangential = (a: Vec, unit: Vec): Vec => plus(a, unit, -dot(a, unit));
