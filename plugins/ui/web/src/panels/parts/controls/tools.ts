/** Tools of the editor: what they do when put down, moved and lifted by mouse, finger, pen, or crosshair. */
import { stroke } from "../pixels/brush";
import type { Drawing } from "../drawing/drawing";
import { labelAt, type Point } from "../pixels/labels";
import type { Proposal } from "../pixels/mask";
import { fillOutline } from "../pixels/polygon";
import { linePixels } from "../pixels/split";

export const TOOLS = ["select", "brush", "lasso", "propose", "split", "join"] as const;
export type Tool = (typeof TOOLS)[number];

export type Fault = "notPainted" | "nothingChanged" | "notSplit" | "notJoined";

/** Distance under which places of an outline are merged, CSS pixels. */
const NEAR_PX = 2;
/** Reach of snapping, and extension of a splitting line, CSS pixels. */
const REACH_PX = 10;

/** The lowest and the highest level of a region's border, in per cent. */
export const LEVELS = [5, 95] as const;

/** How a part is proposed. */
export interface HowToPropose {
  kind: string;
  /** The share of people, 0 to 1, who would draw the border of a region: less gives a smaller piece. */
  level: number;
}

/** Requests of the tools to the server. */
export interface ToolRequests {
  /** Return the part that a stroke of this width lies on; null if a newer stroke replaced the request. */
  propose(stroke: readonly Point[], width_px: number, how: HowToPropose): Promise<Proposal | null>;
  /** Move an outline to edges of the picture within this distance. */
  snap(outline: readonly Point[], reach_px: number): Promise<Point[]>;
}

export class Tools {
  tool: Tool = "select";
  /** Width of the brush, pixels of the picture. */
  width = 1;
  /** True if the next stroke makes a new part. */
  newPart = false;
  /** True if the next proposal is added to the selected part; otherwise it is a new part. */
  addsTo = false;
  erases = false;
  snaps = true;
  how: HowToPropose = { kind: "regions", level: 0.6 };
  down = false;
  /** True while a request is under way. */
  busy = false;
  line: Point[] = [];
  /** The stroke of the last proposal. */
  private proposedBy: readonly Point[] = [];
  /** Return how many pixels of the picture a CSS pixel covers. */
  scale: () => number = () => 1;
  /** Called with the reason if something did not work. */
  onFailure: (why: Fault | Error) => void = () => undefined;
  /** Called when a request starts (true) or ends. */
  onWait: (busy: boolean) => void = () => undefined;
  /** Called with the number of slivers that went to what is around them. */
  onGiven: (slivers: number) => void = () => undefined;
  /** Called with the part that was pointed at. */
  onSelect: (label: number) => void = () => undefined;

  constructor(
    private drawing: Drawing,
    private requests: ToolRequests,
  ) {}

  put(at: Point): void {
    if (this.busy) return;
    this.down = true;
    this.line = [at];
    if (this.tool !== "brush") return;
    this.attempt(() => {
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
      this.onFailure(error as Error);
    }
  }

  /** Cancel the stroke; return whether there was one. */
  cancel(): boolean {
    const was = this.down;
    this.down = false;
    this.line = [];
    this.drawing.cancel();
    return was;
  }

  /** Accept the proposal, as a new part unless it is to be added to the selected one. */
  accept(): void {
    this.attempt(() => {
      this.drawing.given = 0;
      this.finish(this.drawing.accept(this.addsTo ? this.drawing.selected : null));
      this.addsTo = false;
      if (this.drawing.given) this.onGiven(this.drawing.given);
    });
  }

  /** Propose again, from the same stroke, in another way. */
  async change(how: Partial<HowToPropose>): Promise<void> {
    Object.assign(this.how, how);
    if (!this.drawing.proposed || !this.proposedBy.length) return;
    try {
      await this.propose(this.proposedBy);
    } catch (error) {
      this.onFailure(error as Error);
    }
  }

  /** True if the proposal is a region of the picture, of which there is a larger or smaller one. */
  get proposesRegion(): boolean {
    return this.tool === "propose" && this.how.kind === "regions" && this.drawing.proposed !== null && this.proposedBy.length > 0;
  }

  /** Propose a larger region (1) or a smaller one (-1). */
  resizeRegion(by: 1 | -1): Promise<void> {
    const [least, most] = LEVELS;
    return this.change({ level: Math.max(least, Math.min(most, percent(this.how.level) + 10 * by)) / 100 });
  }

  private get target(): number | null {
    return this.newPart ? null : this.drawing.selected;
  }

  private dab(from: Point, to: Point): void {
    const { columns, rows } = this.drawing.labels;
    const spans = stroke(from, to, this.width, columns, rows);
    if (this.drawing.proposed) this.drawing.correct(spans, !this.erases);
    else this.drawing.paint(spans);
  }

  private select([at]: Point[]): void {
    const label = labelAt(this.drawing.labels, ...at!);
    if (label >= 0) this.onSelect(label);
  }

  private brush(): void {
    if (!this.drawing.proposed) this.finish(this.drawing.end());
  }

  private async lasso(line: Point[]): Promise<void> {
    const { columns, rows } = this.drawing.labels;
    const outline = this.snaps && line.length > 2 ? await this.wait(this.requests.snap(line, REACH_PX * this.scale())) : line;
    const spans = fillOutline(outline, columns, rows);
    if (!spans.length) return this.onFailure("notPainted");
    if (this.drawing.proposed) return this.drawing.correct(spans, !this.erases);
    this.drawing.begin(this.target);
    this.drawing.paint(spans);
    this.finish(this.drawing.end());
  }

  private async propose(line: readonly Point[]): Promise<void> {
    this.proposedBy = line;
    const proposal = await this.wait(this.requests.propose(line, this.width, this.how));
    if (proposal) this.drawing.propose(proposal); // null if a newer stroke replaced the request
  }

  private split(drawn: Point[]): void {
    const { labels, selected } = this.drawing;
    const line = extendLine(drawn, REACH_PX * this.scale());
    const met = new Map<number, number>();
    for (const at of linePixels(line, labels)) met.set(labels.data[at]!, (met.get(labels.data[at]!) ?? 0) + 1);
    const most = [...met].sort((a, b) => b[1] - a[1])[0]?.[0] ?? selected;
    if (!this.drawing.split(met.has(selected) ? selected : most, line)) this.onFailure("notSplit");
  }

  private join([at]: Point[]): void {
    const label = labelAt(this.drawing.labels, ...at!);
    if (label < 0) return;
    if (!this.drawing.join(label, this.drawing.selected)) this.onFailure("notJoined");
  }

  private finish(changed: boolean): void {
    if (changed) this.newPart = false;
    else this.onFailure("nothingChanged");
  }

  private attempt(act: () => void): void {
    try {
      act();
    } catch (error) {
      this.down = false;
      this.onFailure(error as Error);
    }
  }

  private async wait<T>(work: Promise<T>): Promise<T> {
    this.onWait((this.busy = true));
    try {
      return await work;
    } finally {
      this.onWait((this.busy = false));
    }
  }
}

export const percent = (level: number): number => Math.round(100 * level);

/** Return a line extended at both ends, as rims are hard to hit exactly. */
function extendLine(line: Point[], by: number): Point[] {
  const beyond = (end: Point, before: Point): Point => {
    const [dx, dy] = [end[0] - before[0], end[1] - before[1]];
    const share = by / (Math.hypot(dx, dy) || Infinity);
    return [end[0] + share * dx, end[1] + share * dy];
  };
  return [beyond(line[0]!, line[1] ?? line[0]!), ...line, beyond(line.at(-1)!, line.at(-2) ?? line[0]!)];
}
