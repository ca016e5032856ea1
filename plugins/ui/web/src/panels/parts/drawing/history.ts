/** Undo and redo of a drawing's steps, and which of them was saved. */
import type { Box } from "../pixels/labels";
import type { Patch } from "../pixels/patch";

export interface Part {
  /** Number in this picture while it is edited. */
  readonly label: number;
  readonly name: string;
  readonly height_m: number;
  /** Null: the rules for materials decide. */
  readonly material: string | null;
  /** True if the program finds the height. */
  readonly automatic: boolean;
}

export interface Step {
  before: readonly Part[];
  after: readonly Part[];
  /** Pixels that changed; null for a change of parts' properties alone. */
  patch: Patch | null;
  box: Box;
  /** Selected part before and after. */
  from: number;
  to: number;
  /** Steps of the same gesture, such as a drag, that follow one another are one step. */
  gesture: string;
}

export class History {
  private done: Step[] = [];
  private undone: Step[] = [];
  /** Number of steps at the last save; -1 if undo cannot lead back to it. */
  private savedAt = 0;

  get length(): number {
    return this.done.length;
  }

  /** The last step; undefined if there is none. */
  get last(): Step | undefined {
    return this.done.at(-1);
  }

  get isSaved(): boolean {
    return this.done.length === this.savedAt;
  }

  get canUndo(): boolean {
    return this.done.length > 0;
  }

  get canRedo(): boolean {
    return this.undone.length > 0;
  }

  /** Mark the state after this many steps as saved. */
  markSaved(steps = this.length): void {
    this.savedAt = steps;
    this.endGesture();
  }

  push(step: Step): void {
    if (this.savedAt > this.done.length) this.savedAt = -1;
    this.done.push(step);
    this.undone = [];
  }

  /** Extend the last step if it is part of this gesture; return whether it is. */
  extend(gesture: string, after: readonly Part[]): boolean {
    const last = this.done.at(-1);
    if (!gesture || last?.gesture !== gesture || this.isSaved) return false;
    last.after = after;
    this.undone = [];
    return true;
  }

  /** Separate the next step from this gesture. */
  endGesture(): void {
    const last = this.done.at(-1);
    if (last) last.gesture = "";
  }

  /** Return the step to take back; undefined if there is none. */
  undo(): Step | undefined {
    const step = this.done.pop();
    if (step) this.undone.push(step);
    return step;
  }

  /** Return the step to do again; undefined if there is none. */
  redo(): Step | undefined {
    const step = this.undone.pop();
    if (step) this.done.push(step);
    return step;
  }
}
