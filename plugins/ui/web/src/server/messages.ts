/** What the server says, by the name of the event; `at_s` is the Unix time. */
import type { Plain } from "../forms/schema";
import type { Hand } from "../hand/hand";
import type { State } from "./protocol";
import type { Scene } from "../surface/scene";

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
  /** Names of the parts, by their labels; null where the parts have none. */
  parts: string[] | null;
  photo: boolean;
  /** Width and height of the finer picture beside the one that is drawn at once; null where that is the finest. */
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

/** What making a product would do; `digest` is that of the text. */
export interface Plan {
  digest: string;
  want: string;
  steps: Outcome[];
  /** Products that take seconds and would be made. */
  slow: string[];
  /** Why it cannot be made; empty where it can. */
  refusal: string;
}

export interface Segment {
  label: number;
  material: string;
  why: string;
  /** Of the area, 0 to 1. */
  share: number;
}

/** `unsafe` is preflight's worst, `illegible` that of legibility. */
export type Grade = "ok" | "warn" | "unsafe" | "illegible";

export interface Verdict {
  check: string;
  of: string;
  verdict: Grade;
  /** How the value stands to its bound, in words. */
  stands: string;
  source: string;
  note: string;
  cure: string;
  says: string;
  changes: { key: string; value: Plain }[];
  /** Places that fail, as shares of the picture from the left and from the top. */
  at?: [number, number][];
}

/** Plain values of a pipeline file. */
export type Values = Record<string, unknown>;

/** A preflight of the text with this digest. */
export interface Judged {
  digest: string;
  grade: Grade;
  sentence: string;
  /** Empty for the page's own hand. */
  device: string;
  law: string;
  /** Whether lateness is that of the loop that gives the forces, and not of the process that judged. */
  of_loop: boolean;
  verdicts: Verdict[];
}

/** What a finger reads. */
export type Medium = "swell" | "print" | "pins" | "force";

/** Whether fingers can read the text with this digest. */
export interface Legible {
  digest: string;
  medium: Medium;
  width_m: number;
  grade: Grade;
  sentence: string;
  verdicts: Verdict[];
}

/** What was exported of the text with this digest; the files lie at /export/<folder>/. */
export interface Exported {
  digest: string;
  folder: string;
  exports: (Pick<Outcome, "outcome" | "why" | "seconds" | "notes"> & {
    name: string;
    files: { name: string; bytes: number }[];
    /** Null for what is not felt. */
    legible: Pick<Legible, "grade" | "sentence" | "verdicts"> | null;
  })[];
}

export interface Document {
  text: string;
  path: string;
  digest: string;
  /** What the text says; null if it is no YAML. */
  said: Values | null;
  /** The same with every default filled in; null if something is wrong. */
  values: Values | null;
  complaints: Complaint[];
  can_undo: boolean;
  can_redo: boolean;
}

interface Said {
  event: string;
  at_s: number;
}

export interface Events {
  hello: Said & { version: number; history: (Said & { event: keyof Events })[]; scene: (Said & Meta) | null };
  gone: Said;
  /** Of this page alone: the program that answers is another one, by its key or by its version. */
  refused: Said & { why: "key" | "version" };
  /** A program before this one ended while this file was edited and not saved; none any more, if path is empty. */
  restored: Said & { path: string; edited_s: number };
  /** free: no tab holds the hand. */
  holding: Said & { holding: boolean; free: boolean };
  maker: Said;
  /** The maker does not start, and is not tried any more. */
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
  /** The surface with this digest in words, and its materials' names, by language. */
  described: Said & { digest: string; says: Record<string, string>; names: Record<string, Record<string, string>> };
  document: Said & Document;
  touch: Said & { law: string; seconds: number; how: string };
  /** stopped: somebody pressed stop; lost: the device went; waiting: it is looked for again and again. */
  loop: Said & {
    running: boolean;
    why: string;
    stopped?: boolean;
    lost?: boolean;
    waiting?: boolean;
    device?: string;
    own_hand?: boolean;
  };
  /** To which part a device guides the hand; null for none. */
  beacon: Said & { part: number | null; name: string; why: "asked" | "button" | "scene" | "ended" };
  /** Another device was chosen. */
  device: Said & { kind: "hand" | "document" | "other"; name: string };
  error: Said & { text: string };
  laws: Said &
    (
      | { state: "one" }
      | { state: "two"; named: [string, string]; felt: number }
      | { state: "blind"; called: number; trials: number; question: string }
    );
  recorder: Said & { recording: boolean; path: string; ticks: number; why: string };
  /** What Python's logging and warnings say, in the server and in the maker. */
  log: Said & { level: "detail" | "warning" | "error"; logger: string; text: string };
  /** Of this page alone: a state that arrived, one that was drawn, a surface that can be drawn. */
  state: State;
  drawn: State;
  shown: Scene;
  /** Something about this page's hand changed: what moves it, how, whether it is felt. */
  hand: Hand;
  /** What is to be shown of the surface, and what is: the picture, heights, segments ... */
  "look at": { look: string };
  look: { look: string };
  /** Something finer of the surface on the screen has come. */
  finer: Scene;
  /** A recording was opened, a file of this machine. */
  recording: { path: string };
  /** Of this page alone: the colours are others now (see `colour` of themes.ts). */
  theme: { chosen: string; dark: boolean; contrast: boolean };
  /** Sound was switched; speech was, or has another voice ("": none). */
  sound: { on: boolean };
  aloud: { on: boolean; voice: string };
  /** Whether every line of the log is to be read out. */
  "read log": { on: boolean };
}
