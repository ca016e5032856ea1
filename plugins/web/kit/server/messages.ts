/** Messages of the server by name; `at_s` is the Unix time. */

/** What JSON can hold. */
export type Plain = string | number | boolean | null | Plain[] | { [key: string]: Plain };

/** Tasks of the page, in their order. */
export const TASKS = ["picture", "parts", "feel", "hand-on"] as const;
export type Task = (typeof TASKS)[number];

export interface Material {
  name: string;
  stiffness_n_per_m: number;
  damping_n_s_per_m: number;
  static_friction: number;
  dynamic_friction: number;
  roughness_m: number;
  grain_m: number;
  texture: string;
  direction_deg: number;
  anisotropy: number;
  irregularity: number;
  drag_n_s_per_m: number;
}

/** Values that can be drawn on a surface; colours run from low to high. */
export interface LayerMeta {
  unit: string;
  low: number;
  high: number;
  rows: number;
  columns: number;
}

/** Metadata of a surface: the meaning of the arrays at /scene/<digest>/. */
export interface Meta {
  digest: string;
  name: string;
  /** Contents: heights and materials; heights alone; or segments over any heights. */
  shows: "surface" | "relief" | "segments";
  /** Size of the finest level, cells. */
  rows: number;
  columns: number;
  extent_m: [number, number];
  /** Lowest and highest height. */
  height_m: [number, number];
  /** Levels of detail, the finest first; a cell is the mean of step x step cells of level 0. The last is drawn first. */
  levels: { step: number; rows: number; columns: number }[];
  /** Number of labels; 0 without any. */
  labels: number;
  label_bytes: 2 | 4;
  /** Materials without repetition; materials.u16 maps labels to them. */
  materials: Material[];
  /** Names of the parts by label; null if parts have none. */
  parts: string[] | null;
  photo: boolean;
  /** Size of the finer picture; null if the first one is the finest. */
  fine_photo: [number, number] | null;
  layers: Record<string, LayerMeta>;
}

export interface Note {
  text: string;
  kind: "decision" | "warning" | "doubt";
}

export interface Outcome {
  product: string;
  outcome: "given" | "ran" | "cached" | "skipped" | "failed" | "refused";
  why: string;
  method: string;
  seconds: number;
  notes: Note[];
}

export interface Complaint {
  location: (string | number)[];
  text: string;
  line: number | null;
  column: number | null;
}

/** Steps that computing a product would take; `digest` identifies the text. */
export interface Plan {
  digest: string;
  want: string;
  steps: Outcome[];
  /** Products that would be computed and take seconds. */
  slow: string[];
  /** Reason why the product cannot be computed; empty if it can. */
  refusal: string;
}

export interface Segment {
  label: number;
  material: string;
  why: string;
  /** Share of the area, 0 to 1. */
  share: number;
}

/** Grades; `unsafe` is preflight's worst, `illegible` that of legibility. */
export type Grade = "ok" | "warn" | "unsafe" | "illegible";

export interface Verdict {
  check: string;
  of: string;
  verdict: Grade;
  /** Comparison of the value with its bound, in words. */
  stands: string;
  source: string;
  note: string;
  cure: string;
  says: string;
  changes: { key: string; value: Plain }[];
  /** Failing places, as shares of the picture from the left and from the top. */
  at?: [number, number][];
}

/** Values of a pipeline file. */
export type Values = Record<string, unknown>;

/** Preflight of the text with this digest. */
export interface Judged {
  digest: string;
  grade: Grade;
  sentence: string;
  /** Name of the device; empty for this page's hand. */
  device: string;
  law: string;
  /** True if lateness was measured in the force loop, false if in the computing process. */
  of_loop: boolean;
  verdicts: Verdict[];
}

/** Medium of a tactile picture. */
export type Medium = "swell" | "print" | "pins" | "force";

/** Tactile legibility of the text with this digest. */
export interface Legible {
  digest: string;
  medium: Medium;
  width_m: number;
  /** True if the parts that are drawn there, and judged, are simplified ones. */
  simplified: boolean;
  grade: Grade;
  sentence: string;
  verdicts: Verdict[];
}

/** Exports of the text with this digest; the files are at /export/<folder>/. */
export interface Exported {
  digest: string;
  folder: string;
  exports: (Pick<Outcome, "outcome" | "why" | "seconds" | "notes"> & {
    name: string;
    files: { name: string; bytes: number }[];
    /** Legibility; null for files that are not tactile. */
    legible: Pick<Legible, "grade" | "sentence" | "verdicts"> | null;
  })[];
}

export interface Document {
  text: string;
  path: string;
  digest: string;
  /** Values as written; null if the text is not YAML. */
  said: Values | null;
  /** Values with all defaults filled in; null if something is wrong. */
  values: Values | null;
  /** What the scene is, and what its relief is made of; null if something is wrong. */
  scene_kind: "photograph" | "depth" | "heights" | null;
  relief_from: "photograph" | "depth" | "heights" | "edges" | "figure" | "lines" | "parts" | null;
  complaints: Complaint[];
  can_undo: boolean;
  can_redo: boolean;
}

/** A panel that a plugin brings: its titles by language, the address of its ES module, and the task that it serves. */
export interface PluginPanel {
  name: string;
  title: Record<string, string>;
  module: string;
  task: Task | "advanced";
}

interface Said {
  event: string;
  at_s: number;
}

export interface Events {
  /** empty: true if the program was started without a file, and none is opened yet. */
  hello: Said & { version: number; history: (Said & { event: keyof Events })[]; scene: (Said & Meta) | null; empty: boolean };
  gone: Said;
  /** Told by the page itself: the program hangs, or answers again. */
  silence: Said & { silent: boolean };
  /** Told by the page itself: the server is another one, by its key or by its version. */
  refused: Said & { why: "key" | "version" };
  /** A previous program ended while this file had unsaved edits; an empty path withdraws the offer. */
  restored: Said & { path: string; edited_s: number };
  /** free: true if no tab holds the hand. */
  holding: Said & { holding: boolean; free: boolean };
  /** A file is opened; without a name: it was not. picture: it can be fetched and shown before there is a surface. */
  opening: Said & { name: string; picture: boolean };
  maker: Said;
  /** The computing process does not start, and is not tried again. */
  maker_gone: Said & { why: string };
  making: Said & { want: string; digest: string };
  made: Said & { want: string; digest: string; outcome: "made" | "stopped" | "failed"; why: string; seconds: number };
  plan: Said & Plan;
  materials: Said & { segments: Segment[] };
  preflight: Said & Judged;
  legible: Said & Legible;
  exported: Said & Exported;
  stage: Said & { product: string; method: string; done: Partial<Outcome> };
  scene: Said & Meta;
  /** Description of the surface with this digest, by language. */
  described: Said & { digest: string; says: Record<string, string> };
  document: Said & Document;
  touch: Said & { law: string; seconds: number; how: string };
  /** stopped: by the stop button; lost: the device was disconnected; waiting: the device is being searched for. */
  loop: Said & {
    running: boolean;
    why: string;
    stopped?: boolean;
    lost?: boolean;
    waiting?: boolean;
    device?: string;
    own_hand?: boolean;
  };
  /** Part that the device guides the hand to; null for none. */
  beacon: Said & { part: number | null; name: string; why: "asked" | "button" | "scene" | "ended" };
  /** The chosen device changed. */
  device: Said & { kind: "hand" | "document" | "other"; name: string };
  /** Progress of fetching a network, bytes; no name at the end, with the reason if it failed. */
  fetching: Said & { name: string; done: number; whole: number; why: string };
  error: Said & { text: string };
  laws: Said & ({ state: "one" } | { state: "two"; named: [string, string]; felt: number });
  recorder: Said & { recording: boolean; path: string; ticks: number; why: string };
  /** Records of Python's logging and warnings, in the server and in the computing process. */
  log: Said & { level: "detail" | "warning" | "error"; logger: string; text: string };
}
