/** What is said to who listens: one sentence a second at most, of each topic the newest alone, nothing twice, nothing
 * stale. What it says goes to live regions, and aloud where a person asked for that. */

export interface How {
  /** What replaces what: of two that wait the newer is said; and what a topic said last is not said again. */
  topic?: string;
  /** Said before all that waits, and into what a screen reader is reading: errors, the stop. */
  urgent?: boolean;
  /** A person asked for it: at once, and again if it is the same as before. */
  asked?: boolean;
}

export interface Said {
  text: string;
  urgent: boolean;
}

export interface Clock {
  now(): number;
  after(ms: number, act: () => void): void;
}

interface Waiting extends Said {
  topic: string;
  atMs: number;
}

export const PAUSE_MS = 1000;
export const STALE_MS = 5000;
/** A sentence without a topic may come again after so long. */
export const AGAIN_MS = 10_000;

const BROWSERS: Clock = { now: () => performance.now(), after: (ms, act) => void setTimeout(act, ms) };

export class Announcer {
  /** Nothing is said, as while a page hears what happened before it was opened. */
  hushed = false;
  private queue: Waiting[] = [];
  private last = new Map<string, { text: string; atMs: number }>();
  private saidMs = -Infinity;
  private due = false;

  constructor(
    private utter: (said: Said) => void,
    private clock: Clock = BROWSERS,
  ) {}

  say(text: string, { topic = text, urgent = false, asked = false }: How = {}): void {
    if (!text || this.hushed) return;
    const atMs = this.clock.now();
    this.queue = this.queue.filter((each) => each.topic !== topic);
    if (asked) {
      this.queue = this.queue.filter((each) => each.urgent);
      this.tell({ text, topic, urgent, atMs });
      return;
    }
    const before = this.last.get(topic);
    if (before?.text === text && (topic !== text || atMs - before.atMs < AGAIN_MS)) return;
    const place = urgent ? this.queue.filter((each) => each.urgent).length : this.queue.length;
    this.queue.splice(place, 0, { text, topic, urgent, atMs });
    this.next();
  }

  /** What a topic says no longer holds: the same may be said again. */
  forget(topic: string): void {
    this.last.delete(topic);
    this.queue = this.queue.filter((each) => each.topic !== topic);
  }

  private next(): void {
    if (this.due) return;
    const now = this.clock.now();
    this.queue = this.queue.filter(({ urgent, atMs }) => urgent || now - atMs <= STALE_MS);
    if (!this.queue.length) return;
    const pause = this.saidMs + PAUSE_MS - now;
    if (pause <= 0) this.tell(this.queue.shift()!);
    if (!this.queue.length) return;
    this.due = true;
    this.clock.after(Math.max(pause, PAUSE_MS * +(pause <= 0)), () => {
      this.due = false;
      this.next();
    });
  }

  private tell({ text, topic, urgent }: Waiting): void {
    this.saidMs = this.clock.now();
    if (this.last.size > 200) this.last.clear();
    this.last.set(topic, { text, atMs: this.saidMs });
    this.utter({ text, urgent });
  }
}

/** Puts what is said into the page's two live regions: #said waits its turn, #alerted does not. */
export function regions(polite: HTMLElement, assertive: HTMLElement): (said: Said) => void {
  return ({ text, urgent }) => {
    const region = urgent ? assertive : polite;
    // A region that is given the text it has says nothing: a space that cannot break tells it apart.
    region.textContent = region.textContent === text ? `${text}\u00a0` : text;
  };
}
