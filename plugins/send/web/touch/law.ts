/** The force law `proxy` of the program, tick by tick: a spring from the hand to a point that stays on the surface.
 *
 * The counterpart of tangible_render/contact: friction holds the proxy, damping acts along the normal. Fine textures of
 * materials are heard, and shake a phone or a game pad; they are not part of the force. */
import type { Vec } from "kit/server/protocol";
import { settle } from "./closest";
import type { Spline } from "./spline";

/** Stiffness in N/m, damping in N s/m, static and dynamic friction. */
export type Row = readonly [number, number, number, number];

const ENTRY_STEPS = 6;
/** Longest step of a hand in a tick, metres: after a longer one its contact begins anew. */
export const LEAP_M = 0.005;
/** Distance at which a proxy is released if the surface above is nearer, metres. */
const STRETCH_M = 0.02;

type Phase = "lost" | "beside" | "free" | "touching";

/** The force on the hand, with the proxy; null while the hand touches nothing. */
export interface Touched {
  force: Vec;
  proxy: Vec;
}

export class ProxyLaw {
  private phase: Phase = "lost";
  private proxy: [number, number] = [NaN, NaN];
  private was: Vec = [NaN, NaN, NaN];
  private slides = false;

  /** row: the properties of the surface at a place. */
  constructor(
    readonly spline: Spline,
    private row: (x: number, y: number) => Row,
  ) {}

  /** Forget the hand: the next tick is its first. */
  release(): void {
    this.phase = "lost";
    this.slides = false;
  }

  tick(hand: Vec, velocity: Vec): Touched | null {
    if (!this.approach(...hand)) return null;
    const [x, y, z] = hand;
    let [px, py] = this.proxy;
    const [stiffness, damping, staticFriction, dynamicFriction] = this.row(px, py);
    let [top, damper, hx, hy] = [z, 0, 0, 0];
    if (this.phase !== "beside") {
      const settled = settle(this.spline, { x: px, y: py, slides: this.slides }, hand, staticFriction, dynamicFriction);
      [px, py, this.slides] = [settled.x, settled.y, settled.slides];
      [top, hx, hy] = settled.at;
      const square = 1 + hx * hx + hy * hy;
      const spring = (stiffness * (hx * (x - px) + hy * (y - py) + top - z)) / square;
      damper = Math.min((damping * (velocity[2] - hx * velocity[0] - hy * velocity[1])) / square, Math.max(spring, 0));
    }
    this.proxy = [px, py];
    const force: Vec = [stiffness * (px - x) + damper * hx, stiffness * (py - y) + damper * hy, stiffness * (top - z) - damper];
    return { force: force.every(Number.isFinite) ? force : [0, 0, 0], proxy: [px, py, top] };
  }

  /** Return whether the hand is in the surface; sets its phase and where the proxy starts. */
  private approach(x: number, y: number, z: number): boolean {
    const { spline, phase, was } = this;
    const [w, l] = [0.5 * spline.widthM, 0.5 * spline.lengthM];
    let [px, py] = this.proxy;
    [this.phase, this.was] = ["lost", [x, y, z]];
    if (!Number.isFinite(x + y + z)) return false;
    if (Math.abs(x) > w || Math.abs(y) > l) {
      this.phase = "beside";
      this.proxy = [Math.min(Math.max(x, -w), w), Math.min(Math.max(y, -l), l)];
      return false;
    }
    this.phase = "free";
    const height = spline.height(x, y);
    if (!(height > z)) return false;
    this.phase = "touching";
    const leap = (x - was[0]) ** 2 + (y - was[1]) ** 2 + (z - was[2]) ** 2 > LEAP_M * LEAP_M;
    if (phase === "beside") [px, py] = Math.abs(px) >= w ? [px, y] : [x, py];
    const apart = (x - px) ** 2 + (y - py) ** 2;
    const far = phase !== "free" && apart > STRETCH_M * STRETCH_M && apart > (height - z) ** 2;
    if (phase === "lost" || leap || far) [px, py] = [x, y];
    else if (phase === "free") [px, py] = this.entry(was, [x, y, z]);
    else if (phase === "beside" && z < spline.height(px, py)) this.phase = "beside";
    if (phase !== "touching" || leap) this.slides = false;
    this.proxy = [px, py];
    return true;
  }

  /** Return where the hand's straight way crossed the surface, within 1/64 of the way, on the outer side. */
  private entry(from: Vec, to: Vec): [number, number] {
    const on = (share: number): Vec => from.map((each, axis) => each + share * (to[axis]! - each)) as Vec;
    let [out, inside] = [0, 1];
    for (let k = 0; k < ENTRY_STEPS; k++) {
      const middle = 0.5 * (out + inside);
      const [x, y, z] = on(middle);
      if (z >= this.spline.height(x, y)) out = middle;
      else inside = middle;
    }
    const [x, y] = on(out);
    return [x, y];
  }
}
