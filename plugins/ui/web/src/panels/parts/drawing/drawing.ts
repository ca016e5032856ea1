/** The parts as they are drawn now, and everything that was done to them, to be taken back and done again. */
import { around, type Box, boxOf, counted, EMPTY, type Labels, type Point, type Span } from "../pixels/labels";
import { Mask, type Proposed, spansOf } from "../pixels/mask";
import { fromFront, moved } from "./order";
import { Patch } from "../pixels/patch";
import { type Found, piecesOf } from "../pixels/pieces";
import { runs, split } from "../pixels/split";

export interface Part {
  /** Its number in this picture, as long as it is edited. */
  readonly label: number;
  readonly name: string;
  readonly height_m: number;
  /** Null: as the rules for materials say. */
  readonly material: string | null;
  /** Its height is found by the program, and not said. */
  readonly automatic: boolean;
}

interface Step {
  before: readonly Part[];
  after: readonly Part[];
  patch: Patch | null;
  box: Box;
  /** What was selected. */
  from: number;
  to: number;
  /** Steps with the same one that follow one another are taken back together. */
  gesture: string;
}

/** The highest number that a part can have; one above is the line that cuts. */
const LAST = 0xfffe;
/** A new part stands in front of what it was painted on. */
const BEFORE_M = 0.001;
/** So often small pieces are given away that small pieces were given to. */
const PASSES = 8;

export class Full extends Error {}

export class Drawing {
  selected: number;
  /** What was proposed; null while nothing is. */
  proposed: Mask | null = null;
  /** Hears which pixels look different, and whether something about the parts does. */
  changed: (box: Box, parts: boolean) => void = () => undefined;
  private counts: Uint32Array;
  private next: number;
  private done: Step[] = [];
  private undone: Step[] = [];
  private kept = 0;
  private stroke: { patch: Patch; label: number; box: Box; fresh: boolean } | null = null;

  constructor(
    readonly labels: Labels,
    public parts: readonly Part[],
    readonly top_m: number,
  ) {
    this.counts = counted(labels);
    this.next = Math.max(-1, ...parts.map((each) => each.label)) + 1;
    this.selected = fromFront(parts)[0]?.label ?? 0;
  }

  get saved(): boolean {
    return this.done.length === this.kept;
  }

  get canUndo(): boolean {
    return this.done.length > 0;
  }

  get canRedo(): boolean {
    return this.undone.length > 0;
  }

  part(label: number): Part | undefined {
    return this.parts.find((each) => each.label === label);
  }

  /** Of the whole picture, from 0 to 1. */
  share(label: number): number {
    return this.counts[label]! / this.labels.data.length;
  }

  /** How much was done: told to `keep` when that was saved. */
  get steps(): number {
    return this.done.length;
  }

  /** What was there after so many steps is what was saved. */
  keep(steps = this.steps): void {
    this.kept = steps;
    this.endGesture();
  }

  /** Change what is said of parts. gesture: drags that go on are one step. */
  set(changes: Map<number, Partial<Part>>, gesture = ""): void {
    const after = this.parts.map((each) => ({ ...each, ...changes.get(each.label) }));
    const last = this.done.at(-1);
    if (gesture && last?.gesture === gesture && this.done.length !== this.kept) {
      last.after = this.parts = after;
      this.undone = [];
      this.changed(EMPTY, true);
    } else this.did({ patch: null, box: EMPTY, after, to: this.selected, gesture });
  }

  /** One part on: what follows is not the same gesture any more. */
  endGesture(): void {
    const last = this.done.at(-1);
    if (last) last.gesture = "";
  }

  order(label: number, by: number): void {
    const heights = new Map(moved(this.parts, label, by, this.top_m).map(({ label, height_m }) => [label, { height_m }]));
    this.set(heights);
  }

  /** Begin to paint: with a part, or (null) with a new one in front of what lies there. */
  begin(label: number | null): number {
    this.stroke = { patch: new Patch(), label: label ?? this.fresh(), box: EMPTY, fresh: label === null };
    return this.stroke.label;
  }

  paint(spans: Span[]): void {
    const { stroke } = this;
    if (!stroke || !spans.length) return;
    stroke.patch.paint(this.labels, spans, stroke.label);
    const box = boxOf(spans);
    stroke.box = around(stroke.box, box);
    this.changed(box, false);
  }

  /** What was painted since `begin` is one step; whether that changed anything. */
  end(): boolean {
    const { stroke } = this;
    this.stroke = null;
    if (!stroke || stroke.patch.isEmpty) return false;
    const { patch, label, box } = stroke;
    const under = stroke.fresh ? this.mostPainted(patch) : undefined;
    const made: Part[] = stroke.fresh ? [this.before(label, under)] : [];
    this.did({ patch: patch.close(), box, after: [...this.parts, ...made], to: label, gesture: "" });
    return true;
  }

  /** As if it had not begun. */
  cancel(): void {
    const { stroke } = this;
    this.stroke = null;
    if (!stroke) return;
    stroke.patch.undo(this.labels.data);
    this.changed(stroke.box, false);
  }

  propose(proposal: Proposed): void {
    this.discard();
    this.proposed = new Mask(this.labels.columns, this.labels.rows);
    this.correct(spansOf(proposal), true);
  }

  correct(spans: Span[], on: boolean): void {
    if (!this.proposed || !spans.length) return;
    this.proposed.put(spans, on);
    this.changed(boxOf(spans), false);
  }

  /** Make what was proposed a part, or (label) more of one. */
  accept(label: number | null): boolean {
    const mask = this.proposed;
    if (!mask) return false;
    this.proposed = null;
    this.begin(label);
    this.paint([...mask.spans()]);
    this.changed(mask.box, false);
    return this.end();
  }

  discard(): void {
    const mask = this.proposed;
    this.proposed = null;
    if (mask) this.changed(mask.box, false);
  }

  /** Give all of a part to another one. */
  join(label: number, into: number): boolean {
    if (label === into || !this.part(label) || !this.part(into)) return false;
    this.begin(into);
    this.paint(this.spansOf(piecesOf(this.labels, label)));
    return this.end();
  }

  /** Whether the line cut the part. */
  split(label: number, line: readonly Point[]): boolean {
    const part = this.part(label);
    if (!part) return false;
    this.room(1);
    const cut = split(this.labels, label, line, this.next);
    if (!cut) return false;
    this.next += cut.fresh.length;
    const made = cut.fresh.map((each) => ({ ...part, label: each, name: this.free(part.name) }));
    this.did({ patch: cut.patch, box: this.whole, after: [...this.parts, ...made], to: cut.fresh[0]!, gesture: "" });
    return true;
  }

  /** Parts that lie in several pieces, with the sizes of these, the largest first. */
  scattered(): Map<number, number[]> {
    const sizes = new Map<number, number[]>();
    for (const { label, pixels } of piecesOf(this.labels).pieces) sizes.set(label, [...(sizes.get(label) ?? []), pixels]);
    return new Map([...sizes].filter(([, all]) => all.length > 1).map(([label, all]) => [label, all.sort((a, b) => b - a)]));
  }

  /**
   * Make each piece a part: the largest of a part stays it, the others are new ones. Pieces of fewer pixels than `least`
   * go to the part before them, or above.
   */
  settle(least: number): void {
    const patch = new Patch();
    for (let pass = 0; pass < PASSES && this.absorb(least, patch); pass++);
    const made: Part[] = [];
    const kept = new Set<number>();
    const found = piecesOf(this.labels);
    for (const { label, root } of found.pieces.sort((a, b) => b.pixels - a.pixels)) {
      if (!kept.has(label)) kept.add(label);
      else {
        const part = this.part(label)!;
        const fresh = this.fresh();
        made.push({ ...part, label: fresh, name: this.free(part.name, made) });
        runs(found, root, (from, to) => patch.put(this.labels.data, from, to, fresh));
      }
    }
    if (!patch.isEmpty)
      this.did({ patch: patch.close(), box: this.whole, after: [...this.parts, ...made], to: this.selected, gesture: "" });
  }

  /** Give small pieces away; whether there were some. One may go to another that goes on in the next pass. */
  private absorb(least: number, patch: Patch): boolean {
    const { data, columns } = this.labels;
    const found = piecesOf(this.labels);
    const largest = new Set<number>();
    let some = false;
    for (const { label, pixels, root } of found.pieces.sort((a, b) => b.pixels - a.pixels)) {
      const isLargest = !largest.has(label);
      largest.add(label);
      if (isLargest || pixels >= least) continue;
      const start = found.starts[root]!;
      const beside = start % columns ? start - 1 : start >= columns ? start - columns : found.ends[root]!;
      const taker = data[beside]!;
      runs(found, root, (from, to) => patch.put(data, from, to, taker));
      some = true;
    }
    return some;
  }

  undo(): boolean {
    const step = this.done.pop();
    if (!step) return false;
    step.patch?.undo(this.labels.data);
    this.count(step, -1);
    this.undone.push(step);
    this.show(step.before, step.from, step.box);
    return true;
  }

  redo(): boolean {
    const step = this.undone.pop();
    if (!step) return false;
    step.patch?.redo(this.labels.data);
    this.count(step, 1);
    this.done.push(step);
    this.show(step.after, step.to, step.box);
    return true;
  }

  private get whole(): Box {
    return { left: 0, top: 0, right: this.labels.columns, bottom: this.labels.rows };
  }

  /** Something was done: parts that nothing is left of are gone. */
  private did(step: Omit<Step, "before" | "from">): void {
    const whole = { ...step, before: this.parts, from: this.selected };
    this.count(whole, 1);
    whole.after = step.after.filter(({ label }) => this.counts[label]);
    if (!whole.after.some(({ label }) => label === whole.to)) whole.to = fromFront(whole.after)[0]?.label ?? 0;
    if (this.kept > this.done.length) this.kept = -1; // what was saved cannot be come back to
    this.done.push(whole);
    this.undone = [];
    this.show(whole.after, whole.to, whole.box);
  }

  private show(parts: readonly Part[], selected: number, box: Box): void {
    this.parts = parts;
    this.selected = selected;
    this.changed(box, true);
  }

  private count({ patch }: Step, sign: 1 | -1): void {
    patch?.each((_, length, before, after) => {
      this.counts[before]! -= sign * length;
      this.counts[after]! += sign * length;
    });
  }

  private spansOf({ starts, ends }: Found): Span[] {
    const { columns } = this.labels;
    return [...starts].map((start, i) => {
      const row = Math.floor(start / columns);
      return [row, start - row * columns, ends[i]! - row * columns];
    });
  }

  private room(parts: number): void {
    if (this.next + parts > LAST) throw new Full();
  }

  private fresh(): number {
    this.room(1);
    return this.next++;
  }

  private before(label: number, under: number | undefined): Part {
    const ground = this.part(under ?? -1)?.height_m ?? 0;
    return { label, name: "", height_m: Math.min(this.top_m, ground + BEFORE_M), material: null, automatic: false };
  }

  /** Of the pixels of a patch, whose most of them were. */
  private mostPainted(patch: Patch): number | undefined {
    const counts = new Map<number, number>();
    patch.each((_, length, before) => counts.set(before, (counts.get(before) ?? 0) + length));
    return [...counts].sort((a, b) => b[1] - a[1])[0]?.[0];
  }

  /** A name like this one that no part has. */
  private free(name: string, more: Part[] = []): string {
    if (!name) return "";
    const taken = new Set([...this.parts, ...more].map((each) => each.name));
    let count = 2;
    while (taken.has(`${name} ${count}`)) count++;
    return `${name} ${count}`;
  }
}
