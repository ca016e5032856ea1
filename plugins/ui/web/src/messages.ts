/** What the server says, by the name of the event; `at_s` is the Unix time. */
import type { State } from "./protocol";
import type { Scene } from "./scene";

export interface Material {
  name: string;
  stiffness_n_per_m: number;
  damping_n_s_per_m: number;
  static_friction: number;
  dynamic_friction: number;
  roughness_m: number;
  grain_m: number;
  texture: string;
  drag_n_s_per_m: number;
}

/** A surface: what the arrays at /scene/<digest>/ mean. */
export interface Meta {
  digest: string;
  name: string;
  rows: number;
  columns: number;
  extent_m: [number, number];
  /** Lowest and highest. */
  height_m: [number, number];
  materials: Material[];
  photo: boolean;
}

export interface Outcome {
  product: string;
  outcome: "given" | "ran" | "cached" | "skipped" | "failed" | "refused";
  why: string;
  method: string;
  seconds: number;
}

export interface Complaint {
  location: (string | number)[];
  text: string;
}

/** Plain values of a pipeline file. */
export type Values = Record<string, unknown>;

interface Said {
  event: string;
  at_s: number;
}

export interface Events {
  hello: Said & { version: number; history: (Said & { event: keyof Events })[]; scene: (Said & Meta) | null };
  gone: Said;
  holding: Said & { holding: boolean };
  maker: Said;
  making: Said & { want: string };
  stage: Said & { product: string; method: string; done: Partial<Outcome> };
  scene: Said & Meta;
  document: Said & { text: string; path: string; values: Values | null; complaints: Complaint[] };
  touch: Said & { law: string; seconds: number; how: string };
  loop: Said & { running: boolean; why: string };
  error: Said & { text: string };
  recorder: Said & { recording: boolean; path: string; ticks: number; why: string };
  /** Of this page alone: a state that arrived, one that was drawn, a surface that can be drawn. */
  state: State;
  drawn: State;
  shown: Scene;
  /** A recording was opened, a file of this machine. */
  recording: { path: string };
  /** Of this page alone: the colours are others now (see `colour` of themes.ts). */
  theme: { chosen: string; dark: boolean; contrast: boolean };
}
