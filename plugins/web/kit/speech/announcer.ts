/** Announcements for screen readers and speech: one after the other, only the newest of each topic, no repetition, none
 * stale. */
import { speakable } from "./speakable";

/** A text, or a function that returns it when its turn comes: what is no longer true by then is left out, as "". */
export type Text = string | (() => string);

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

interface Waiting {
  text: Text;
  urgent: boolean;
  topic: string;
  atMs: number;
}

/** Milliseconds from one announcement to the next: the shortest; those of a letter, at half again the usual speed of
 * speech, so that a sentence is not cut off by the next one; and the longest, shorter than what makes others stale. */
export const PAUSE_MS = 1000;
export const LETTER_MS = 50;
export const LONGEST_PAUSE_MS = 4000;
export const STALE_MS = 5000;
/** Milliseconds after which a text without a topic may be repeated. */
export const AGAIN_MS = 10_000;

export const BROWSERS: Clock = { now: () => performance.now(), after: (ms, act) => void setTimeout(act, ms) };

export class Announcer {
  /** True while nothing is announced, as while a page replays earlier messages. */
  muted = false;
  private queue: Waiting[] = [];
  private last = new Map<string, { text: string; atMs: number }>();
  private saidMs = -Infinity;
  /** Time that the last announcement takes. */
  private lastsMs = PAUSE_MS;
  private dueMs = Infinity;

  constructor(
    private utter: (message: Said) => void,
    private clock: Clock = BROWSERS,
  ) {}

  /** Announce a text; one that is a function has a topic. */
  say(text: Text, { topic = String(text), urgent = false, asked = false }: Announcement = {}): void {
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
    const now = this.clock.now();
    this.queue = this.queue.filter(({ urgent, atMs }) => urgent || now - atMs <= STALE_MS);
    while (this.queue.length && this.turnMs(this.queue[0]!) <= now) this.utterNow(this.queue.shift()!);
    if (!this.queue.length) return;
    const turnMs = this.turnMs(this.queue[0]!);
    if (this.dueMs <= turnMs) return;
    this.dueMs = turnMs;
    this.clock.after(turnMs - now, () => {
      this.dueMs = Infinity;
      this.next();
    });
  }

  /** Return when an announcement may be made: an urgent one does not wait for the end of a long sentence. */
  private turnMs({ urgent }: Waiting): number {
    return this.saidMs + (urgent ? PAUSE_MS : this.lastsMs);
  }

  private utterNow({ text, topic, urgent }: Waiting): void {
    const words = speakable(typeof text === "string" ? text : text());
    if (!words) return;
    this.saidMs = this.clock.now();
    this.lastsMs = Math.min(LONGEST_PAUSE_MS, Math.max(PAUSE_MS, LETTER_MS * words.length));
    if (this.last.size > 200) this.last.clear();
    this.last.set(topic, { text: typeof text === "string" ? text : words, atMs: this.saidMs });
    this.utter({ text: words, urgent });
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
