/** The hand's connection in a sent page: the force law runs in the page itself, and every state comes at once. */
import type { Hub } from "kit/hub";
import { FLAGS, NOBODY_M, now, STATUS, TAGS, type State, type Vec } from "kit/server/protocol";
import { LEAP_M, type ProxyLaw } from "./touch/law";

/** Longest way of the hand in a tick of the law, metres: a part of what it takes for a leap. */
const STEP_M = LEAP_M / 20;
const MAX_TICKS = 200;
/** Times between two positions that give a velocity, seconds. */
const BETWEEN_S = { least: 0.001, most: 0.1 };
/** Time after which a hand that left is reported once more, ms: the narration waits for it to come back. */
const LEFT_MS = 1100;
const KEPT_TAGS = 512;
const NOWHERE: Vec = [0, 0, 2 * NOBODY_M];
const NONE: Vec = [0, 0, 0];
const NO_PROXY: Vec = [NaN, NaN, NaN];

export class LocalServer {
  latest: State | null = null;
  readonly sentMs = new Map<number, number>();
  private seq = 0;
  private leaving = 0;
  private last: { hand: Vec; ms: number } | null = null;

  constructor(
    private hub: Hub,
    private law: ProxyLaw,
  ) {}

  point(hand: Vec): void {
    const ms = now();
    const before = this.last?.hand ?? hand;
    const seconds = Math.min(Math.max((ms - (this.last?.ms ?? ms)) / 1000, BETWEEN_S.least), BETWEEN_S.most);
    const velocity = hand.map((each, axis) => (each - before[axis]!) / seconds) as Vec;
    const far = Math.hypot(...hand.map((each, axis) => each - before[axis]!));
    const ticks = Math.min(Math.max(Math.ceil(far / STEP_M), 1), MAX_TICKS);
    const on = (share: number): Vec => before.map((each, axis) => each + share * (hand[axis]! - each)) as Vec;
    let touched = null;
    for (let tick = 1; tick <= ticks; tick++) touched = this.law.tick(on(tick / ticks), velocity);
    this.last = { hand, ms };
    this.tell(hand, velocity, touched?.force ?? NONE, touched?.proxy ?? NO_PROXY, touched ? FLAGS.TOUCHING : 0);
  }

  release(): void {
    this.law.release();
    this.last = null;
    const gone = (): void => this.tell(NOWHERE, NONE, NONE, NO_PROXY, 0);
    gone();
    clearTimeout(this.leaving);
    this.leaving = window.setTimeout(() => this.last ?? gone(), LEFT_MS);
  }

  stop(): Promise<void> {
    this.release();
    return Promise.resolve();
  }

  feel(): Promise<void> {
    return Promise.resolve();
  }

  /** Refuse a request: there is no program behind this page. */
  ask<T>(): Promise<T> {
    return Promise.reject(new Error("a sent page asks nobody"));
  }

  drawn(): void {
    // nobody waits for it
  }

  private tell(hand: Vec, velocity: Vec, force: Vec, proxy: Vec, flags: number): void {
    const tag = ++this.seq & TAGS;
    const at = now();
    this.sentMs.set(tag, at);
    this.sentMs.delete((tag - KEPT_TAGS) & TAGS);
    const status = STATUS.RUNNING | STATUS.HOLDING;
    this.latest = { status, flags, seq: this.seq, tag, overruns: 0, sampleMs: at, hand, proxy, force, velocity, other: NONE, lateUs: 0, arrivedMs: at };
    this.hub.tell("state", this.latest);
  }
}
