/** A reading of a state: the numbers that overlay and data cursor share. */
import type { Material } from "../server/messages";
import { FLAGS, NOBODY_M, type State, type Vec } from "../server/protocol";
import type { Scene } from "../surface/scene";
import { GripRule, type Grip } from "./grip";
import { tangential, dot, length } from "./vectors";


export interface Reading {
  readonly state: State;
  /** True if there is a hand. */
  readonly seen: boolean;
  readonly touching: boolean;
  readonly hand: Vec;
  /** Proxy; null for a law without one. */
  readonly proxy: Vec | null;
  /** Contact: the proxy, or the surface above the hand. */
  readonly contact: Vec;
  /** Normal of the surface at the contact. */
  readonly normal: Vec;
  /** Height of the surface above or under the hand; NaN outside. */
  readonly surfaceM: number;
  /** Penetration; 0 above the surface. */
  readonly depthM: number;
  readonly newtons: number;
  /** Parts of the force along the normal and along the surface. */
  readonly normalN: number;
  readonly tangentialN: number;
  readonly otherN: number;
  readonly speedMPerS: number;
  readonly material: Material | null;
  readonly part: number | null;
  /** Name of the part; empty if it has none. */
  readonly name: string;
  readonly grip: Grip;
}

/** Properties of a place of the surface. */
export interface SurfacePlace {
  at: Vec;
  normal: Vec;
  material: Material | null;
  /** Number of the segment; null outside. */
  part: number | null;
  /** Name of the part; empty if it has none. */
  name: string;
}

export function place(scene: Scene, x: number, y: number): SurfacePlace {
  const [normal, material] = [scene.normal(x, y), scene.material(x, y)];
  return { at: [x, y, scene.height(x, y)], normal, material, part: scene.label(x, y), name: scene.part(x, y) };
}

/** Reader of consecutive states: the contact's motion depends on earlier ones. */
export class StateReader {
  private rule = new GripRule();

  read(state: State, scene: Scene | null): Reading {
    const { hand, force } = state;
    const seen = hand[2] < NOBODY_M;
    const touching = seen && (state.flags & FLAGS.TOUCHING) !== 0;
    const surfaceM = scene ? scene.height(hand[0], hand[1]) : NaN;
    const proxy = touching && Number.isFinite(state.proxy[2]) ? state.proxy : null;
    const contact: Vec = proxy ?? [hand[0], hand[1], Number.isFinite(surfaceM) ? surfaceM : hand[2]];
    const normal: Vec = scene ? scene.normal(contact[0], contact[1]) : [0, 0, 1];
    const material = scene && seen ? scene.material(contact[0], contact[1]) : null;
    const dynamicFriction = material?.dynamic_friction ?? 0;
    return {
      state, seen, touching, hand, proxy, contact, normal, surfaceM, material,
      depthM: seen && hand[2] < surfaceM ? surfaceM - hand[2] : 0,
      newtons: length(force),
      normalN: dot(force, normal),
      tangentialN: length(tangential(force, normal)),
      otherN: length(state.other),
      speedMPerS: length(state.velocity),
      part: scene && seen ? scene.label(contact[0], contact[1]) : null,
      name: scene && seen ? scene.part(contact[0], contact[1]) : "",
      grip: this.rule.update({ touching, atMs: state.sampleMs, contact, normal, force, dynamicFriction }),
    };
  }
}
