/** What a hand met since the last announcement, as sentences that are composed when their turn comes. */
import type { Clock } from "./announcer";
import { decimal } from "../words/words";
import type { Side } from "./stroke";
import { t } from "./words";

export type Contact = "touching" | "inTheAir" | "noHand";

/** Something met. what: the part and material behind it, in words; heights are metres. */
export type Told =
  | { kind: "contact"; contact: Contact; what: string }
  | { kind: "edge"; what: string; riseM: number }
  | { kind: "slope"; riseM: number; heightM: number }
  | { kind: "rim"; side: Side }
  | { kind: "off"; side: Side };

/** Step at an edge below which both sides are level, metres. */
export const LEVEL_M = 0.0002;
/** Sentences of an announcement; of more, the last ones, after the number of edges left out. */
const MAX_SENTENCES = 2;
/** Age at which what was met is no longer news, ms. */
const MAX_AGE_MS = 2000;

export class Telling {
  private waiting: (Told & { atMs: number })[] = [];
  private contact: Contact | null = null;

  constructor(private clock: Pick<Clock, "now">) {}

  get isEmpty(): boolean {
    return !this.waiting.length;
  }

  add(told: Told): void {
    const { waiting } = this;
    const before = waiting.at(-1);
    if (told.kind === "edge" && before?.kind === "slope") waiting.pop(); // the slope is the edge's own
    if (told.kind === "slope" && before?.kind === "slope" && Math.sign(before.riseM) === Math.sign(told.riseM)) {
      waiting.pop();
      told = { ...told, riseM: told.riseM + before.riseM };
    }
    if (told.kind === "contact") {
      if (before?.kind === "contact") waiting.pop(); // what ended before it was announced
      if (told.contact === this.contact && told.contact !== "touching" && !waiting.length) return;
    }
    waiting.push({ ...told, atMs: this.clock.now() });
  }

  clear(): void {
    this.waiting = [];
  }

  /** Return the sentences, and forget what they tell; what is old is not said any more. */
  take(): string {
    const nowMs = this.clock.now();
    for (const each of this.waiting) if (each.kind === "contact") this.contact = each.contact;
    const last = this.waiting.filter(({ kind }) => kind === "contact").at(-1); // still true, however long it waited
    const all = this.waiting.filter((each) => each === last || nowMs - each.atMs <= MAX_AGE_MS);
    this.waiting = [];
    const left = Math.max(0, all.length - MAX_SENTENCES);
    const told = all.slice(left);
    const over = all.slice(0, left).filter(({ kind }) => kind === "edge").length;
    return [...(over ? [t(over === 1 ? "oneLeftOut" : "leftOut", { count: over })] : []), ...told.map(sentence)].join(" ");
  }
}

function sentence(told: Told): string {
  if (told.kind === "contact") return t(told.contact, { what: told.what });
  if (told.kind === "rim" || told.kind === "off") return t(`${told.side} ${told.kind}`);
  const by = millimetres(Math.abs(told.riseM));
  if (told.kind === "slope") return t(told.riseM > 0 ? "rises" : "falls", { by, height: millimetres(told.heightM) });
  if (Number.isNaN(told.riseM)) return t("back", { what: told.what });
  if (Math.abs(told.riseM) < LEVEL_M) return t("level", { what: told.what });
  return t(told.riseM > 0 ? "up" : "down", { by, what: told.what });
}

/** Return a length in millimetres, to a tenth below 10. */
export const millimetres = (metres: number): string => decimal(1000 * metres, Math.abs(metres) < 0.01 ? 1 : 0);
