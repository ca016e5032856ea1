/** What a hand comes over on its way along a surface: edges of parts, the rim of the picture, rises and falls. */
import type { Scene } from "../surface/scene";

type Ground = Pick<Scene, "height" | "label" | "meta">;
type Place = readonly [x: number, y: number];

export type Side = "left" | "right" | "near" | "far";
/** What is come over, with its place; heights are metres. */
export type Met = { at: Place } & (
  | { kind: "edge"; riseM: number }
  | { kind: "slope"; riseM: number; heightM: number }
  | { kind: "rim"; side: Side }
  | { kind: "off"; side: Side }
);

/** Distance behind an edge from which it counts as crossed, metres: a hand that trembles on it crosses nothing. */
export const CROSSED_M = 0.0005;
/** Distance to both sides of an edge at which heights are compared, metres: beyond what smooths it, less in a narrow part. */
const BESIDE_M = 0.0025;
/** Distance to the rim at which it is met, and from which on it can be met again, metres. */
const RIM_M = { met: 0.0006, left: 0.003 };
/** Smallest rise or fall within a part, metres, and as a share of the relief: the greater counts. */
const SLOPE = { leastM: 0.0005, share: 0.15 };
/** Longest way between two places that is walked, metres: beyond it the hand was set down elsewhere. */
const LONGEST_M = 0.1;
const FINEST_M = 0.0001;

export class Stroke {
  private at: Place = [NaN, NaN];
  private label: number | null = null;
  /** The last place in the present part. */
  private inside: Place = this.at;
  /** The place of the last edge. */
  private edge: Place = this.at;
  /** The sides that were met and not left again. */
  private rims = new Set<Side>();
  /** Height from which a rise or fall is measured. */
  private baseM = NaN;

  constructor(private ground: Ground) {}

  /** Set the hand down, or lift it to another place. */
  begin(at: Place): void {
    this.at = this.inside = at;
    this.edge = [NaN, NaN];
    this.label = this.ground.label(...at);
    this.baseM = this.ground.height(...at);
    this.rims = new Set(this.sides(at, RIM_M.left));
  }

  /** Walk to a place; return what is met on the way, in order. */
  to(place: Place): Met[] {
    const [x, y] = this.at;
    const far = Math.hypot(place[0] - x, place[1] - y);
    const met: Met[] = [];
    if (!(far <= LONGEST_M)) this.begin(place);
    const steps = far <= LONGEST_M ? Math.ceil(far / Math.max(FINEST_M, this.pitchM)) : 0;
    for (let i = 1; i <= steps; i++) this.step([x + ((place[0] - x) * i) / steps, y + ((place[1] - y) * i) / steps], met);
    return met;
  }

  private get pitchM(): number {
    return this.ground.meta.extent_m[0] / this.ground.meta.columns;
  }

  private step(at: Place, met: Met[]): void {
    const from = this.at;
    this.at = at;
    this.meetRim(at, met);
    const label = this.ground.label(...at);
    if (label === this.label) this.inside = at;
    else if (distance(at, this.inside) >= CROSSED_M) this.cross(label, at, met);
    if (label === this.label && !this.besideEdge(at, from)) this.climb(at, met);
  }

  private cross(label: number | null, at: Place, met: Met[]): void {
    const [before, after] = [this.heightBeside(this.inside, at), this.heightBeside(at, this.inside)];
    if (label === null) met.push({ kind: "off", at, side: this.sides(at, RIM_M.left)[0] ?? "near" });
    else met.push({ kind: "edge", at, riseM: after - before });
    [this.label, this.inside, this.edge, this.baseM] = [label, at, at, after];
  }

  /** Return whether a place is on the slope of an edge that was crossed, or lies ahead: its sentence is about the edge. */
  private besideEdge(at: Place, from: Place): boolean {
    const far = distance(at, from);
    const ahead = at.map((part, axis) => part + ((part - from[axis]!) / far) * BESIDE_M) as unknown as Place;
    return distance(at, this.edge) < BESIDE_M || this.ground.label(...ahead) !== this.label;
  }

  /** Return the height of the part at a place, measured away from another place: the edge between them is smoothed. */
  private heightBeside(at: Place, from: Place): number {
    const far = distance(at, from);
    const way: Place = [(at[0] - from[0]) / far, (at[1] - from[1]) / far];
    const on = (metres: number): Place => [at[0] + metres * way[0], at[1] + metres * way[1]];
    const label = this.ground.label(...at);
    let run = 0;
    while (run < 2 * BESIDE_M && this.ground.label(...on(run + FINEST_M)) === label) run += FINEST_M;
    return this.ground.height(...on(Math.min(BESIDE_M, run / 2)));
  }

  private meetRim(at: Place, met: Met[]): void {
    for (const side of this.sides(at, Math.max(RIM_M.met, this.pitchM))) {
      if (!this.rims.has(side)) met.push({ kind: "rim", at, side });
      this.rims.add(side);
    }
    const near = this.sides(at, RIM_M.left);
    for (const side of this.rims) if (!near.includes(side)) this.rims.delete(side);
  }

  /** Return the sides of the picture that are as near as this, or beyond which a place is. */
  private sides([x, y]: Place, metres: number): Side[] {
    const [w, l] = this.ground.meta.extent_m;
    const near: [Side, number][] = [["left", x + w / 2], ["right", w / 2 - x], ["near", y + l / 2], ["far", l / 2 - y]];
    return near.filter(([, each]) => each <= metres).map(([side]) => side);
  }

  private climb(at: Place, met: Met[]): void {
    const [low, high] = this.ground.meta.height_m;
    const heightM = this.ground.height(...at);
    const riseM = heightM - this.baseM;
    if (Math.abs(riseM) < Math.max(SLOPE.leastM, SLOPE.share * (high - low))) return;
    this.baseM = heightM;
    met.push({ kind: "slope", at, riseM, heightM });
  }
}

const distance = (a: Place, b: Place): number => Math.hypot(a[0] - b[0], a[1] - b[1]);
