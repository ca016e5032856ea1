/** State of each product from the program's messages: first the plan, then running stages, then outcomes. */
import type { Note, Outcome, Plan } from "kit/server/messages";

export type StateOf = "waiting" | "running" | "ran" | "cached" | "given" | "skipped" | "refused" | "failed" | "stopped";

export interface Row {
  product: string;
  method: string;
  state: StateOf;
  why: string;
  notes: Note[];
  seconds: number;
  /** Start by the page's clock; 0 if it is not running. */
  beganMs: number;
  /** Duration of the last run, seconds; 0 if unknown. */
  expected: number;
}

export class StageTable {
  /** Rows in the order of computation. */
  rows: Row[] = [];
  running = false;
  private took = new Map<string, number>();
  private digest = "";
  private later: Plan | null = null;

  /** Take over a plan; while something is computed, a plan for another text waits. */
  setPlan(plan: Plan): void {
    if (this.running && plan.digest !== this.digest) this.later = plan;
    else if (plan.steps.length) this.rows = plan.steps.map((step) => this.plannedRow(step));
  }

  start(digest: string): void {
    this.running = true;
    this.digest = digest;
    this.later = null;
  }

  update(product: string, method: string, done: Partial<Outcome>, nowMs: number): void {
    const row = this.row(product);
    row.method = method || row.method;
    if (!done.outcome) {
      row.state = "running";
      row.beganMs = nowMs;
      row.expected = this.took.get(`${product} ${row.method}`) ?? 0;
      return;
    }
    row.state = done.outcome;
    row.beganMs = 0;
    row.notes = done.notes ?? [];
    row.why = withoutNotes(done.why ?? "", row.notes);
    row.seconds = done.seconds ?? 0;
    if (done.outcome === "ran") this.took.set(`${product} ${row.method}`, row.seconds);
  }

  /** End the computation; unfinished stages were stopped, or failed. */
  end(outcome: "made" | "stopped" | "failed"): void {
    this.running = false;
    for (const row of this.rows) {
      if (row.state === "running") row.state = outcome === "failed" ? "failed" : "stopped";
      else if (row.state === "waiting" && outcome !== "made") row.state = "stopped";
      row.beganMs = 0;
    }
    if (this.later) this.setPlan(this.later);
    this.later = null;
  }

  private plannedRow(step: Outcome): Row {
    const state: StateOf = step.outcome === "ran" ? "waiting" : step.outcome;
    const { product, method, why, notes } = step;
    return { product, method, state, why: withoutNotes(why, notes), notes, seconds: 0, beganMs: 0, expected: this.took.get(`${product} ${method}`) ?? 0 };
  }

  private row(product: string): Row {
    const found = this.rows.find((each) => each.product === product);
    if (found) return found;
    const made: Row = { product, method: "", state: "waiting", why: "", notes: [], seconds: 0, beganMs: 0, expected: 0 };
    this.rows.push(made);
    return made;
  }
}

/** Return the reason without the notes that follow it: these are listed separately. */
export function withoutNotes(why: string, notes: Note[]): string {
  const behind = notes.map(({ text }) => `; ${text}`).join("");
  return behind && why.endsWith(behind) ? why.slice(0, -behind.length) : why;
}

/** Return the progress of a running stage, 0 to 1, by its last duration; null if unknown. */
export function progressOf({ beganMs, expected }: Row, nowMs: number): number | null {
  if (!expected) return null;
  return Math.min(0.98, (nowMs - beganMs) / 1000 / expected);
}
