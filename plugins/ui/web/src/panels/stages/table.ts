/** What becomes of each product, from what the program says: first the plan, then what runs, then what became of it. */
import type { Note, Outcome, Plan } from "../../server/messages";

export type StateOf = "waiting" | "running" | "ran" | "cached" | "given" | "skipped" | "refused" | "failed" | "stopped";

export interface Row {
  product: string;
  method: string;
  state: StateOf;
  why: string;
  notes: Note[];
  seconds: number;
  /** When it began, by the page's clock; 0 where it does not run. */
  beganMs: number;
  /** What it took last time, in seconds; 0 where that is not known. */
  expected: number;
}

export class StageTable {
  /** In the order of making. */
  rows: Row[] = [];
  running = false;
  private took = new Map<string, number>();
  private digest = "";
  private later: Plan | null = null;

  /** What making would do. While something is made, a plan for another text waits. */
  plan(plan: Plan): void {
    if (this.running && plan.digest !== this.digest) this.later = plan;
    else if (plan.steps.length) this.rows = plan.steps.map((step) => this.planned(step));
  }

  making(digest: string): void {
    this.running = true;
    this.digest = digest;
    this.later = null;
  }

  stage(product: string, method: string, done: Partial<Outcome>, nowMs: number): void {
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
    row.why = alone(done.why ?? "", row.notes);
    row.seconds = done.seconds ?? 0;
    if (done.outcome === "ran") this.took.set(`${product} ${row.method}`, row.seconds);
  }

  /** Making ended; what had begun and was not finished was stopped, or failed. */
  made(outcome: "made" | "stopped" | "failed"): void {
    this.running = false;
    for (const row of this.rows) {
      if (row.state === "running") row.state = outcome === "failed" ? "failed" : "stopped";
      else if (row.state === "waiting" && outcome !== "made") row.state = "stopped";
      row.beganMs = 0;
    }
    if (this.later) this.plan(this.later);
    this.later = null;
  }

  private planned(step: Outcome): Row {
    const state: StateOf = step.outcome === "ran" ? "waiting" : step.outcome;
    const { product, method, why, notes } = step;
    return { product, method, state, why: alone(why, notes), notes, seconds: 0, beganMs: 0, expected: this.took.get(`${product} ${method}`) ?? 0 };
  }

  private row(product: string): Row {
    const found = this.rows.find((each) => each.product === product);
    if (found) return found;
    const made: Row = { product, method: "", state: "waiting", why: "", notes: [], seconds: 0, beganMs: 0, expected: 0 };
    this.rows.push(made);
    return made;
  }
}

/** Why, without the notes that follow it in one sentence: they are listed by themselves. */
export function alone(why: string, notes: Note[]): string {
  const behind = notes.map(({ text }) => `; ${text}`).join("");
  return behind && why.endsWith(behind) ? why.slice(0, -behind.length) : why;
}

/** How far a running stage is, 0 to 1, by what it took last time; null where that is not known. */
export function share({ beganMs, expected }: Row, nowMs: number): number | null {
  if (!expected) return null;
  return Math.min(0.98, (nowMs - beganMs) / 1000 / expected);
}
