/** Announcements for screen readers and speech: at most one a second, only the newest of each topic, no repetition, none
 * stale. */

export interface Announcement {
  /** Topic: of two waiting texts the newer is announced, and a topic's last text is not repeated. */
  topic?: string;
  /** True for errors and the stop: announced first, interrupting a screen reader. */
  urgent?: boolean;
  /** True if a person requested it: announced at once, also if it repeats the last text. */
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
/** Milliseconds after which a text without a topic may be repeated. */
export const AGAIN_MS = 10_000;

const BROWSERS: Clock = { now: () => performance.now(), after: (ms, act) => void setTimeout(act, ms) };

export class Announcer {
  /** True while nothing is announced, as while a page replays earlier messages. */
  muted = false;
  private queue: Waiting[] = [];
  private last = new Map<string, { text: string; atMs: number }>();
  private saidMs = -Infinity;
  private due = false;

  constructor(
    private utter: (message: Said) => void,
    private clock: Clock = BROWSERS,
  ) {}

  say(text: string, { topic = text, urgent = false, asked = false }: Announcement = {}): void {
    if (!text || this.muted) return;
    const atMs = this.clock.now();
    this.queue = this.queue.filter((each) => each.topic !== topic);
    if (asked) {
      this.queue = this.queue.filter((each) => each.urgent);
      this.utterNow({ text, topic, urgent, atMs });
      return;
    }
    const before = this.last.get(topic);
    if (before?.text === text && (topic !== text || atMs - before.atMs < AGAIN_MS)) return;
    const place = urgent ? this.queue.filter((each) => each.urgent).length : this.queue.length;
    this.queue.splice(place, 0, { text, topic, urgent, atMs });
    this.next();
  }

  /** Allow a topic's last text to be announced again. */
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
    if (pause <= 0) this.utterNow(this.queue.shift()!);
    if (!this.queue.length) return;
    this.due = true;
    this.clock.after(Math.max(pause, PAUSE_MS * +(pause <= 0)), () => {
      this.due = false;
      this.next();
    });
  }

  private utterNow({ text, topic, urgent }: Waiting): void {
    this.saidMs = this.clock.now();
    if (this.last.size > 200) this.last.clear();
    this.last.set(topic, { text, atMs: this.saidMs });
    this.utter({ text, urgent });
  }
}

/** Return a function that writes announcements into the two live regions: #said is polite, #alerted assertive. */
export function liveRegions(polite: HTMLElement, assertive: HTMLElement): (message: Said) => void {
  return ({ text, urgent }) => {
    const region = urgent ? assertive : polite;
    // a region with an unchanged text is not read: a no-break space makes it different
    region.textContent = region.textContent === text ? `${text}\u00a0` : text;
  };
}
