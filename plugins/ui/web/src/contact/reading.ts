/** What is drawn of a state: the numbers that its pieces and the data cursor share. */
import type { Material } from "../server/messages";
import { FLAGS, type State, type Vec } from "../server/protocol";
import type { Scene } from "../surface/scene";
import { GripRule, type Grip } from "./grip";
import { across, dot, length } from "./vectors";

/** A device without a hand stands a metre high. */
export const NOBODY_M = 0.5;

export interface Live {
  readonly state: State;
  /** Whether there is a hand at all. */
  readonly seen: boolean;
  readonly touching: boolean;
  readonly hand: Vec;
  /** Null where the law has none. */
  readonly proxy: Vec | null;
  /** The proxy, or the surface above the hand. */
  readonly contact: Vec;
  /** Of the surface at the contact. */
  readonly normal: Vec;
  /** Of the surface above or under the hand; NaN beside it. */
  readonly surfaceM: number;
  /** How far the hand is under the surface; 0 above it. */
  readonly depthM: number;
  readonly newtons: number;
  /** The force's parts along the normal, and along the surface. */
  readonly normalN: number;
  readonly tangentialN: number;
  readonly otherN: number;
  readonly speedMPerS: number;
  readonly material: Material | null;
  readonly part: number | null;
  /** Of the part; empty where it has none. */
  readonly name: string;
  readonly grip: Grip;
}

/** What a place of the surface is: its height, what it is made of, and which part. */
export interface Place {
  at: Vec;
  normal: Vec;
  material: Material | null;
  /** Number of the segment; null beside the surface. */
  part: number | null;
  /** Its name; empty where it has none. */
  name: string;
}

export function place(scene: Scene, x: number, y: number): Place {
  const [normal, material] = [scene.normal(x, y), scene.material(x, y)];
  return { at: [x, y, scene.height(x, y)], normal, material, part: scene.label(x, y), name: scene.part(x, y) };
}

/** Follows the states, and says what each means on the surface. */
export class Reading {
  private rule = new GripRule();

  of(state: State, scene: Scene | null): Live {
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
      tangentialN: length(across(force, normal)),
      otherN: length(state.other),
      speedMPerS: length(state.velocity),
      part: scene && seen ? scene.label(contact[0], contact[1]) : null,
      name: scene && seen ? scene.part(contact[0], contact[1]) : "",
      grip: this.rule.next({ touching, atMs: state.sampleMs, contact, normal, force, dynamicFriction }),
    };
  }
}
