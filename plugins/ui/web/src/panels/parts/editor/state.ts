/** State of the parts editor: drawing, tools, crosshair, notice and saved state. It knows neither elements nor texts;
 * view, speech and saving subscribe to it. */
import { Hub } from "kit/hub";
import { shownNumber } from "kit/words/part_words";
import { type Fault, type Tool, type ToolRequests, Tools } from "../controls/tools";
import { Drawing, Full, type Part } from "../drawing/drawing";
import type { Step } from "../drawing/history";
import { type PictureDetails, roundShapes } from "../drawing/picture_details";
import { type Box, labelAt, type Point } from "../pixels/labels";
import { findNeighbours, findPlaces, type Place } from "../pixels/pieces";
import type { FirstParts, Opened, Saved } from "./requests";
import type { Word } from "./words";

/** Brushes side by side along the picture's longer side, at first. */
const FIRST_BRUSHES = 40;
/** Factor by which a key changes the brush's width; at least a pixel. */
const WIDTH_FACTOR = 1.25;

/** A line of text for the person: a word of the table, its values, and the part that {name} stands for. */
export interface Notice {
  word: Word;
  values?: Record<string, string | number>;
  /** The selected part if it is left out; -1: outside of the picture. */
  label?: number;
  bad: boolean;
}

/** Heights and materials by the number of the part in the file (null: the program finds it), and the shape of all parts. */
export interface Update {
  heights_m: (number | null)[];
  materials: (string | null)[];
  heights: object;
}

/** Events of the state for its subscribers. */
export interface EditorEvents {
  /** Pixels in this box look different. */
  pixels: Box;
  /** Parts, or their properties, changed. */
  parts: null;
  /** Places, numbers and neighbours of the parts were found again. */
  survey: null;
  /** The person selected this part. */
  selected: number;
  /** The selected part was moved to the front or back, or its height changed by a key. */
  reordered: null;
  /** Change of tool, or of painting a new part. */
  tool: Tool | "newPart";
  /** The brush's width was changed by a key. */
  width: number;
  /** Change of anything that the toolbar shows. */
  options: null;
  /** The crosshair was moved by keys. */
  crosshair: Point;
  /** The crosshair was moved into this part. */
  entered: number;
  /** The tool was put down at the crosshair, or lifted; or a part is proposed after that. */
  pen: "down" | "up" | "proposed";
  /** The notice was set; the person asked where the crosshair is. */
  notice: Notice;
  where: Notice;
}

export class EditorState {
  readonly events = new Hub<EditorEvents>();
  readonly drawing: Drawing;
  readonly tools: Tools;
  readonly details: PictureDetails;
  /** Position of the crosshair or pointer; null before the first. */
  crosshair: Point | null = null;
  places = new Map<number, Place>();
  neighbours: Part[] = [];
  /** Shown in place of the tool's help; null for the help. */
  notice: Notice | null = null;
  /** True while a save runs: undo waits for it. */
  saving = false;
  /** Digest of the document that the parts were read from, or saved to. */
  digest: string;
  /** The pipeline file; empty while there is none. */
  file: string;
  /** Folder of the photograph, in which a new file may be written; empty if it may not. */
  readonly beside: string;
  /** Numbers that the parts will have in the file. */
  private order = new Map<number, number>();
  /** Numbers that parts had when they were opened or saved. */
  private numbers: Map<number, number>;
  private detailsSaved = true;
  /** The step that proposed parts at the start; undefined without one, or once parts are saved. */
  private started: Step | undefined;
  /** The update of the opened or saved parts. */
  private baseline: Update;

  constructor(scene: Omit<Opened, "picture">, requests: ToolRequests) {
    const { labels, parts, top_m, digest, heights, title, language, file, beside } = scene;
    this.digest = digest;
    this.file = file;
    this.beside = beside;
    this.details = { heights: { ...heights, ...roundShapes(heights) }, title, language };
    this.drawing = new Drawing(labels, parts, top_m);
    this.numbers = new Map(parts.map(({ label }) => [label, label]));
    this.tools = new Tools(this.drawing, requests);
    this.tools.width = Math.max(1, Math.round(Math.max(labels.columns, labels.rows) / FIRST_BRUSHES));
    this.tools.newPart = parts.length === 1;
    this.baseline = this.update({ heights_m: [], materials: [], heights: {} });
    this.drawing.onChange = (box, partsToo) => this.onDrawing(box, partsToo);
    this.tools.onFailure = (why) => this.fail(why);
    this.tools.onWait = (busy) => (busy ? this.notify("proposing", false) : this.clearNotice());
    this.tools.onGiven = (count) => (count === 1 ? this.notify("givenOne", false) : this.notify("given", false, { count }));
    this.tools.onSelect = (label) => this.select(label);
  }

  /** Begin with the parts that the program proposes, unless something is drawn already. */
  begin(proposed: FirstParts | null): void {
    if (this.drawing.history.length || this.tools.down || this.drawing.proposed) return;
    if (!proposed) return this.clearNotice();
    this.drawing.divide(proposed.labels, proposed.heights_m);
    this.started = this.drawing.history.last;
    this.tools.newPart = false;
    this.survey();
    this.notify("started", false, { count: proposed.heights_m.length });
  }

  /** Return whether nothing would be lost: the program's own proposal is found again. */
  get isSaved(): boolean {
    const { history } = this.drawing;
    return (history.isSaved || (!!history.last && history.last === this.started)) && this.detailsSaved;
  }

  /** Return the number by which people know a part: that of its key in the file, from 1. */
  numberOf(label: number): number {
    return shownNumber(this.order.get(label) ?? label);
  }

  /** Return whether a part was opened or saved: its height and material take effect at once. */
  isFelt(label: number): boolean {
    return this.numbers.has(label);
  }

  /** Find places, numbers and neighbours again, which takes time on large pictures. */
  survey(): void {
    const { labels, selected, parts } = this.drawing;
    this.places = findPlaces(labels);
    this.order = new Map([...this.places.keys()].map((label, i) => [label, i]));
    const touching = findNeighbours(labels, selected);
    this.neighbours = parts.filter(({ label }) => touching.has(label));
    this.events.tell("survey", null);
  }

  notify(word: Word, bad: boolean, values: Notice["values"] = {}): void {
    this.notice = { word, values, bad };
    this.events.tell("notice", this.notice);
  }

  /** Show the tool's help again. */
  clearNotice(): void {
    this.notice = null;
    this.events.tell("options", null);
  }

  /** Show why something did not work. */
  fail(why: Fault | Error): void {
    if (why instanceof Full) this.notify("full", true);
    else if (why instanceof Error) this.notify("failed", true, { why: why.message });
    else this.notify(why, true);
  }

  select(label: number): void {
    this.drawing.history.endGesture();
    this.drawing.selected = label;
    if (this.tools.tool !== "select") this.tools.newPart = false;
    this.survey();
    this.events.tell("selected", label);
  }

  /** Merge a part into the selected one. */
  join(label: number): void {
    try {
      this.drawing.join(label, this.drawing.selected);
    } catch (error) {
      this.fail(error as Error);
    }
  }

  use(tool: Tool): void {
    this.tools.cancel();
    this.tools.tool = tool;
    this.notice = null;
    this.events.tell("tool", tool);
  }

  /** Paint a new part, or the selected one; a picture of one part has nothing else to paint. */
  toggleNewPart(): void {
    const { tools, drawing } = this;
    tools.newPart = !tools.newPart || drawing.parts.length === 1;
    if (tools.tool === "select") tools.tool = "brush";
    this.notice = null;
    this.events.tell("tool", "newPart");
  }

  /** Make the brush wider (1) or narrower (-1), or a region that is proposed larger or smaller. */
  resizeBrush(by: 1 | -1): void {
    if (this.tools.proposesRegion) {
      void this.tools.resizeRegion(by).then(() => this.events.tell("pen", "proposed"));
      return this.lifted();
    }
    const { width } = this.tools;
    const { columns, rows } = this.drawing.labels;
    const wanted = by > 0 ? Math.max(width + 1, width * WIDTH_FACTOR) : Math.min(width - 1, width / WIDTH_FACTOR);
    this.tools.width = Math.max(1, Math.min(Math.max(columns, rows), Math.round(wanted)));
    this.lifted();
    this.events.tell("width", this.tools.width);
  }

  step(which: "undo" | "redo"): void {
    if (this.tools.down || this.tools.busy || this.saving) return;
    this.drawing.discard();
    const done = this.drawing[which]();
    if (which === "undo") this.notify(done ? "undone" : "nothingToUndo", false);
    else this.notify(done ? "redone" : "nothingToRedo", false);
  }

  /** Cancel the stroke or the proposal; return whether there was one. */
  cancel(): boolean {
    if (this.tools.cancel()) this.lifted();
    else if (this.drawing.proposed) this.drawing.discard();
    else return false;
    return true;
  }

  /** Update the help after a stroke; a complaint stays. */
  lifted(): void {
    if (!this.tools.busy && !this.notice?.bad) this.notice = null;
    this.events.tell("options", null);
  }

  /** Return the crosshair; where there is none yet, set it to the selected part. */
  placeCrosshair(): Point {
    if (!this.crosshair) this.moveCrosshair(0, 0);
    return this.crosshair!;
  }

  /** Move the crosshair by pixels of the picture, with the tool if it is down. */
  moveCrosshair(dx: number, dy: number): void {
    const { labels, selected } = this.drawing;
    const { columns, rows } = labels;
    const from = this.crosshair ?? this.places.get(selected)?.at ?? [columns / 2, rows / 2];
    const before = labelAt(labels, ...from);
    const within = (at: number, most: number): number => Math.max(0, Math.min(most - 1, Math.floor(at))) + 0.5;
    const at: Point = [within(from[0] + dx, columns), within(from[1] + dy, rows)];
    this.crosshair = at;
    if (dx || dy) this.tools.move(at);
    this.events.tell("crosshair", at);
    const now = labelAt(labels, ...at);
    if (now !== before && this.tools.tool !== "brush") this.events.tell("entered", now);
  }

  /** Put the tool down at the crosshair, or lift it there. */
  async pen(): Promise<void> {
    const { tools } = this;
    const at = this.placeCrosshair();
    if (!tools.down) {
      tools.put(at);
      if (tools.tool !== "select" && tools.tool !== "join") return this.events.tell("pen", "down");
    }
    tools.move(at);
    if (tools.tool !== "select") this.events.tell("pen", "up");
    await tools.lift();
    this.lifted();
    if (this.drawing.proposed) this.events.tell("pen", "proposed");
  }

  /** Finish or accept: what Enter does on the picture. */
  finish(): void {
    if (this.drawing.proposed && !this.tools.down) this.tools.accept();
    else void this.pen();
  }

  tellWhere(): void {
    const { labels } = this.drawing;
    const [x, y] = this.placeCrosshair();
    const values = { x: Math.round((100 * x) / labels.columns), y: Math.round((100 * y) / labels.rows) };
    this.notice = { word: "where", values, label: labelAt(labels, x, y), bad: false };
    this.events.tell("where", this.notice);
  }

  /** Change title, language or the shape of all parts. */
  setDetails(change: Partial<PictureDetails>): void {
    Object.assign(this.details, change);
    this.detailsSaved = false;
  }

  /** Return title, language and the shape of the parts, as they are saved. */
  get savedDetails(): PictureDetails {
    const automatic = this.drawing.parts.some((each) => each.automatic);
    const { heights, title, language } = this.details;
    return { heights: { ...heights, by: automatic ? heights.by : "given" }, title: title.trim(), language: language.trim() || "en" };
  }

  /** Return heights and materials of the parts that were opened or saved, by their numbers. */
  update(base: Update = this.baseline): Update {
    const [heights_m, materials] = [[...base.heights_m], [...base.materials]];
    for (const { label, height_m, material, automatic } of this.drawing.parts) {
      const number = this.numbers.get(label);
      if (number === undefined) continue;
      heights_m[number] = automatic ? null : height_m;
      materials[number] = material;
    }
    return { heights_m, materials, heights: this.savedDetails.heights };
  }

  get base(): Update {
    return this.baseline;
  }

  /** Take over a save. parts and steps: those at its start. */
  markSaved(saved: Saved, parts: readonly Part[], steps: number): void {
    this.digest = saved.digest;
    this.file = saved.file;
    this.started = undefined;
    this.numbers = new Map(parts.map(({ label }) => [label, saved.numbers[label]![0]!]));
    this.baseline = this.update({ heights_m: [], materials: [], heights: {} });
    this.drawing.history.markSaved(steps);
    this.detailsSaved = true;
    this.survey();
  }

  private onDrawing(box: Box, parts: boolean): void {
    this.events.tell("pixels", box);
    if (parts) {
      if (this.drawing.parts.length === 1) this.tools.newPart = true; // there is nothing else to paint
      this.notice = null;
      this.events.tell("parts", null);
    } else this.events.tell("options", null);
  }
}
