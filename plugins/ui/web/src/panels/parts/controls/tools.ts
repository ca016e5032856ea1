/** What the tools do where they are put down, moved and lifted: with a mouse, a finger, a pen, or the crosshair. */
import type { Net } from "../../../server/connection";
import { proposed, snapped } from "../editor/requests";
import { stroke } from "../pixels/brush";
import type { Drawing } from "../drawing/drawing";
import { labelAt, type Point } from "../pixels/labels";
import { filled } from "../pixels/polygon";
import { lineOf } from "../pixels/split";

export const TOOLS = ["select", "brush", "lasso", "propose", "split", "join"] as const;
export type Tool = (typeof TOOLS)[number];

export type Fault = "notPainted" | "nothingChanged" | "notSplit" | "notJoined";

/** Places of an outline that are nearer to one another than so much of the page are one. */
const NEAR_PX = 2;
/** How far an edge snaps, and a line that cuts goes on beyond its ends, in pixels of the page. */
const REACH_PX = 10;

export class Pens {
  tool: Tool = "select";
  /** Of the brush, in pixels of the picture. */
  width = 1;
  /** The next stroke makes a new part. */
  fresh = false;
  takesAway = false;
  snaps = true;
  kind = "grabcut";
  down = false;
  /** The program is looking for something. */
  busy = false;
  line: Point[] = [];
  /** Hears what could not be done, and why. */
  failed: (why: Fault | Error) => void = () => undefined;
  /** Hears that the program is looking for something, or has looked. */
  waits: (busy: boolean) => void = () => undefined;
  /** Hears which part was pointed at. */
  chose: (label: number) => void = () => undefined;

  constructor(
    private drawing: Drawing,
    private net: Net,
    /** Pixels of the picture for one of the page. */
    private scale: () => number,
  ) {}

  put(at: Point): void {
    if (this.busy) return;
    this.down = true;
    this.line = [at];
    if (this.tool !== "brush") return;
    this.tried(() => {
      if (!this.drawing.proposed) this.drawing.begin(this.target);
      this.dab(at, at);
    });
  }

  move(at: Point): void {
    if (!this.down) return;
    const last = this.line.at(-1)!;
    if (this.tool === "brush") {
      this.dab(last, at);
      this.line = [at];
    } else if (Math.hypot(at[0] - last[0], at[1] - last[1]) >= NEAR_PX * this.scale()) this.line.push(at);
  }

  async lift(): Promise<void> {
    if (!this.down) return;
    this.down = false;
    const { line } = this;
    this.line = [];
    try {
      await this[this.tool](line);
    } catch (error) {
      this.failed(error as Error);
    }
  }

  /** As if it had not been put down. */
  cancel(): boolean {
    const was = this.down;
    this.down = false;
    this.line = [];
    this.drawing.cancel();
    return was;
  }

  accept(): void {
    this.tried(() => this.done(this.drawing.accept(this.target)));
  }

  private get target(): number | null {
    return this.fresh ? null : this.drawing.selected;
  }

  private dab(from: Point, to: Point): void {
    const { columns, rows } = this.drawing.labels;
    const spans = stroke(from, to, this.width, columns, rows);
    if (this.drawing.proposed) this.drawing.correct(spans, !this.takesAway);
    else this.drawing.paint(spans);
  }

  private select([at]: Point[]): void {
    const label = labelAt(this.drawing.labels, ...at!);
    if (label >= 0) this.chose(label);
  }

  private brush(): void {
    if (!this.drawing.proposed) this.done(this.drawing.end());
  }

  private async lasso(line: Point[]): Promise<void> {
    const { columns, rows } = this.drawing.labels;
    const outline = this.snaps && line.length > 2 ? await this.asked(snapped(this.net, line, REACH_PX * this.scale())) : line;
    const spans = filled(outline, columns, rows);
    if (!spans.length) return this.failed("notPainted");
    if (this.drawing.proposed) return this.drawing.correct(spans, !this.takesAway);
    this.drawing.begin(this.target);
    this.drawing.paint(spans);
    this.done(this.drawing.end());
  }

  private async propose(line: Point[]): Promise<void> {
    const found = await this.asked(proposed(this.net, line, this.width, this.kind));
    if (found) this.drawing.propose(found); // none, if another stroke came before this one was looked at
  }

  private split(drawn: Point[]): void {
    const { labels, selected } = this.drawing;
    const line = lengthened(drawn, REACH_PX * this.scale());
    const met = new Map<number, number>();
    for (const at of lineOf(line, labels)) met.set(labels.data[at]!, (met.get(labels.data[at]!) ?? 0) + 1);
    const most = [...met].sort((a, b) => b[1] - a[1])[0]?.[0] ?? selected;
    if (!this.drawing.split(met.has(selected) ? selected : most, line)) this.failed("notSplit");
  }

  private join([at]: Point[]): void {
    const label = labelAt(this.drawing.labels, ...at!);
    if (label < 0) return;
    if (!this.drawing.join(label, this.drawing.selected)) this.failed("notJoined");
  }

  private done(changed: boolean): void {
    if (changed) this.fresh = false;
    else this.failed("nothingChanged");
  }

  private tried(act: () => void): void {
    try {
      act();
    } catch (error) {
      this.down = false;
      this.failed(error as Error);
    }
  }

  private async asked<T>(work: Promise<T>): Promise<T> {
    this.waits((this.busy = true));
    try {
      return await work;
    } finally {
      this.waits((this.busy = false));
    }
  }
}

/** A line that goes on at both ends as it began and ended: nobody hits a rim to the pixel. */
function lengthened(line: Point[], by: number): Point[] {
  const beyond = (end: Point, before: Point): Point => {
    const [dx, dy] = [end[0] - before[0], end[1] - before[1]];
    const share = by / (Math.hypot(dx, dy) || Infinity);
    return [end[0] + share * dx, end[1] + share * dy];
  };
  return [beyond(line[0]!, line[1] ?? line[0]!), ...line, beyond(line.at(-1)!, line.at(-2) ?? line[0]!)];
}
