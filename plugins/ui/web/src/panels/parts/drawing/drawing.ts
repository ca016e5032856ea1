/** The parts of a picture while they are edited, with undo and redo of every change. */
import { type Box, boundingBox, countPixels, EMPTY, type Labels, type Point, type Span, union } from "../pixels/labels";
import { Mask, type Proposal, toSpans } from "../pixels/mask";
import { Patch } from "../pixels/patch";
import { findPieces, type Pieces } from "../pixels/pieces";
import { eachRun, split } from "../pixels/split";
import { giveAway, type Limits, sliversOf } from "../pixels/tidy";
import { History, type Part, type Step } from "./history";
import { frontToBack, reorder } from "./order";

export type { Part };

/** Highest label of a part; the one above marks pixels of a cut (pixels/split.ts). */
const LAST = 0xfffe;
/** Height of a new part above the part it is painted on, metres. */
const BEFORE_M = 0.001;

const NEW = { name: "", material: null, automatic: false };

/** Thrown when no label is left for a new part. */
export class Full extends Error {}

export class Drawing {
  selected: number;
  /** The proposed part; null while there is none. */
  proposed: Mask | null = null;
  readonly history = new History();
  /** Slivers that the last accepted proposal left to what is around them. */
  given = 0;
  /** Called with the box of pixels that look different, and whether parts changed too. */
  onChange: (box: Box, parts: boolean) => void = () => undefined;
  private counts: Uint32Array;
  private next: number;
  private stroke: { patch: Patch; label: number; box: Box; isNew: boolean } | null = null;

  constructor(
    readonly labels: Labels,
    public parts: readonly Part[],
    readonly top_m: number,
    readonly limits: Limits = sliversOf(labels),
  ) {
    this.counts = countPixels(labels);
    this.next = Math.max(-1, ...parts.map((each) => each.label)) + 1;
    this.selected = frontToBack(parts)[0]?.label ?? 0;
  }

  part(label: number): Part | undefined {
    return this.parts.find((each) => each.label === label);
  }

  /** Return a part's share of the picture, 0 to 1. */
  share(label: number): number {
    return this.counts[label]! / this.labels.data.length;
  }

  /** Change properties of parts, by label. gesture: changes of one drag are one step. */
  set(changes: Map<number, Partial<Part>>, gesture = ""): void {
    const after = this.parts.map((each) => ({ ...each, ...changes.get(each.label) }));
    if (this.history.extend(gesture, after)) {
      this.parts = after;
      this.onChange(EMPTY, true);
    } else this.record({ patch: null, box: EMPTY, after, to: this.selected, gesture });
  }

  /** Move a part towards the front by some places; back if negative. */
  order(label: number, by: number): void {
    const heights = new Map(reorder(this.parts, label, by, this.top_m).map(({ label, height_m }) => [label, { height_m }]));
    this.set(heights);
  }

  /** Start a stroke of a part, or of a new part (null); return its label. Throws Full. */
  begin(label: number | null): number {
    this.stroke = { patch: new Patch(), label: label ?? this.newLabel(), box: EMPTY, isNew: label === null };
    return this.stroke.label;
  }

  paint(spans: Span[]): void {
    const { stroke } = this;
    if (!stroke || !spans.length) return;
    stroke.patch.paint(this.labels, spans, stroke.label);
    const box = boundingBox(spans);
    stroke.box = union(stroke.box, box);
    this.onChange(box, false);
  }

  /** End the stroke as one step; return whether it changed a pixel. */
  end(): boolean {
    const { stroke } = this;
    this.stroke = null;
    if (!stroke || stroke.patch.isEmpty) return false;
    const { patch, label, box } = stroke;
    const added = stroke.isNew ? [this.partInFront(label, this.mostOverpainted(patch))] : [];
    this.record({ patch: patch.close(), box, after: [...this.parts, ...added], to: label, gesture: "" });
    return true;
  }

  /** Undo the stroke that was begun. */
  cancel(): void {
    const { stroke } = this;
    this.stroke = null;
    if (!stroke) return;
    stroke.patch.undo(this.labels.data);
    this.onChange(stroke.box, false);
  }

  propose(proposal: Proposal): void {
    this.discard();
    this.proposed = new Mask(this.labels.columns, this.labels.rows);
    this.correct(toSpans(proposal), true);
  }

  /** Add pixels to the proposal, or remove them. */
  correct(spans: Span[], on: boolean): void {
    if (!this.proposed || !spans.length) return;
    this.proposed.put(spans, on);
    this.onChange(boundingBox(spans), false);
  }

  /** Divide a picture of one part into others, as one step. labels: the number of each pixel's part, from 0. */
  divide(labels: Uint16Array, heights_m: readonly number[]): void {
    this.checkRoom(heights_m.length);
    const first = this.next;
    this.next += heights_m.length;
    const patch = new Patch();
    for (let at = 0, end = 0; at < labels.length; at = end) {
      while (end < labels.length && labels[end] === labels[at]) end++;
      patch.put(this.labels.data, at, end, first + labels[at]!);
    }
    const parts = heights_m.map((height_m, i) => ({ ...NEW, label: first + i, height_m: Math.min(this.top_m, height_m) }));
    this.record({ patch: patch.close(), box: this.whole, after: parts, to: frontToBack(parts)[0]!.label, gesture: "" });
  }

  /** Add the proposal to a part, or make it a new one (null); return whether that changed a pixel.
   *
   * Slivers that it leaves of other parts go to what is around them, in the same step; `given` has their number. */
  accept(label: number | null): boolean {
    const mask = this.proposed;
    if (!mask) return false;
    this.proposed = null;
    const into = this.begin(label);
    this.paint([...mask.spans()]);
    this.onChange(mask.box, false);
    const cut = new Set<number>();
    this.stroke!.patch.each((_, _length, before) => cut.add(before));
    const keeps = (each: number): boolean => !cut.has(each) || !!this.part(each)?.name;
    this.given = giveAway(this.labels, this.limits, this.stroke!.patch, keeps, into);
    if (this.given) this.stroke!.box = this.whole;
    return this.end();
  }

  discard(): void {
    const mask = this.proposed;
    this.proposed = null;
    if (mask) this.onChange(mask.box, false);
  }

  /** Merge a part into another; return whether both exist and differ. */
  join(label: number, into: number): boolean {
    if (label === into || !this.part(label) || !this.part(into)) return false;
    this.begin(into);
    this.paint(this.spansOf(findPieces(this.labels, label)));
    return this.end();
  }

  /** Split a part along a line; return whether the line crosses it. */
  split(label: number, line: readonly Point[]): boolean {
    const part = this.part(label);
    if (!part) return false;
    this.checkRoom(1);
    const cut = split(this.labels, label, line, this.next);
    if (!cut) return false;
    this.next += cut.fresh.length;
    const added = cut.fresh.map((each) => ({ ...part, label: each, name: this.freeName(part.name) }));
    this.record({ patch: cut.patch, box: this.whole, after: [...this.parts, ...added], to: cut.fresh[0]!, gesture: "" });
    return true;
  }

  /** Return parts in several pieces, with the pieces' sizes in pixels, the largest first. */
  scattered(): Map<number, number[]> {
    const sizes = new Map<number, number[]>();
    for (const { label, pixels } of findPieces(this.labels).pieces) sizes.set(label, [...(sizes.get(label) ?? []), pixels]);
    return new Map([...sizes].filter(([, all]) => all.length > 1).map(([label, all]) => [label, all.sort((a, b) => b - a)]));
  }

  /** Give slivers to what is around them, as one step, but no whole part; return how many went. */
  tidy(): number {
    const patch = new Patch();
    const given = giveAway(this.labels, this.limits, patch, () => true);
    if (given) this.record({ patch: patch.close(), box: this.whole, after: this.parts, to: this.selected, gesture: "" });
    return given;
  }

  /** Make each piece a part: a part's largest piece stays it. */
  settle(): void {
    const patch = new Patch();
    const added: Part[] = [];
    const seen = new Set<number>();
    const found = findPieces(this.labels);
    for (const { label, root } of found.pieces.sort((a, b) => b.pixels - a.pixels)) {
      if (!seen.has(label)) seen.add(label);
      else {
        const part = this.part(label)!;
        const fresh = this.newLabel();
        added.push({ ...part, label: fresh, name: this.freeName(part.name, added) });
        eachRun(found, root, (from, to) => patch.put(this.labels.data, from, to, fresh));
      }
    }
    if (!patch.isEmpty)
      this.record({ patch: patch.close(), box: this.whole, after: [...this.parts, ...added], to: this.selected, gesture: "" });
  }

  /** Take the last step back; return whether there was one. */
  undo(): boolean {
    const step = this.history.undo();
    if (!step) return false;
    step.patch?.undo(this.labels.data);
    this.count(step, -1);
    this.show(step.before, step.from, step.box);
    return true;
  }

  /** Do the last undone step again; return whether there was one. */
  redo(): boolean {
    const step = this.history.redo();
    if (!step) return false;
    step.patch?.redo(this.labels.data);
    this.count(step, 1);
    this.show(step.after, step.to, step.box);
    return true;
  }

  private get whole(): Box {
    return { left: 0, top: 0, right: this.labels.columns, bottom: this.labels.rows };
  }

  /** Record a step; parts without a pixel are removed. */
  private record(step: Omit<Step, "before" | "from">): void {
    const whole = { ...step, before: this.parts, from: this.selected };
    this.count(whole, 1);
    whole.after = step.after.filter(({ label }) => this.counts[label]);
    if (!whole.after.some(({ label }) => label === whole.to)) whole.to = frontToBack(whole.after)[0]?.label ?? 0;
    this.history.push(whole);
    this.show(whole.after, whole.to, whole.box);
  }

  private show(parts: readonly Part[], selected: number, box: Box): void {
    this.parts = parts;
    this.selected = selected;
    this.onChange(box, true);
  }

  private count({ patch }: Step, sign: 1 | -1): void {
    patch?.each((_, length, before, after) => {
      this.counts[before]! -= sign * length;
      this.counts[after]! += sign * length;
    });
  }

  private spansOf({ starts, ends }: Pieces): Span[] {
    const { columns } = this.labels;
    return [...starts].map((start, i) => {
      const row = Math.floor(start / columns);
      return [row, start - row * columns, ends[i]! - row * columns];
    });
  }

  private checkRoom(parts: number): void {
    if (this.next + parts > LAST) throw new Full();
  }

  private newLabel(): number {
    this.checkRoom(1);
    return this.next++;
  }

  private partInFront(label: number, under: number | undefined): Part {
    const ground = this.part(under ?? -1)?.height_m ?? 0;
    return { ...NEW, label, height_m: Math.min(this.top_m, ground + BEFORE_M) };
  }

  /** Return the part that had most of a patch's pixels. */
  private mostOverpainted(patch: Patch): number | undefined {
    const counts = new Map<number, number>();
    patch.each((_, length, before) => counts.set(before, (counts.get(before) ?? 0) + length));
    return [...counts].sort((a, b) => b[1] - a[1])[0]?.[0];
  }

  /** Return a name like this one that no part has. */
  private freeName(name: string, more: Part[] = []): string {
    if (!name) return "";
    const taken = new Set([...this.parts, ...more].map((each) => each.name));
    let count = 2;
    while (taken.has(`${name} ${count}`)) count++;
    return `${name} ${count}`;
  }
}
