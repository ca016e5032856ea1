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

/** Values that can be warped over a surface; colours run from low to high. */
export interface LayerMeta {
  unit: string;
  low: number;
  high: number;
  rows: number;
  columns: number;
}

/** A surface: what the arrays at /scene/<digest>/ mean. */
export interface Meta {
  digest: string;
  name: string;
  /** Heights and materials; heights alone; or segments over whatever heights there are. */
  shows: "surface" | "relief" | "segments";
  /** Of the finest level. */
  rows: number;
  columns: number;
  extent_m: [number, number];
  /** Lowest and highest. */
  height_m: [number, number];
  /** Level 0 is the finest; a cell of another is a mean over step x step of its cells. The last is drawn at once. */
  levels: { step: number; rows: number; columns: number }[];
  /** How many labels there are; 0 without any. */
  labels: number;
  label_bytes: 2 | 4;
  /** Each once; which of them a label has is in materials.u16. */
  materials: Material[];
  photo: boolean;
  /** Width and height of the finer picture beside the one that is drawn at once; null where that is the finest. */
  fine_photo: [number, number] | null;
  layers: Record<string, LayerMeta>;
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
  /** Of this page alone: a state that arrived, one that was drawn, a surface that can be drawn. */
  state: State;
  drawn: State;
  shown: Scene;
  /** Something finer of the surface on the screen has come. */
  finer: Scene;
  /** A recording was opened, a file of this machine. */
  recording: { path: string };
}
