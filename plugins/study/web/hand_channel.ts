/** The hand's connection on a participant's page: a position goes out, and the newest state comes back as the answer. */
import type { Hub } from "kit/hub";
import { encodePointer, encodeRelease, now, parseState, TAGS, type State, type Vec } from "kit/server/protocol";

const KEPT_TAGS = 512;

export class HandChannel {
  latest: State | null = null;
  readonly sentMs = new Map<number, number>();
  private tag = 0;
  private next: ArrayBuffer | null = null;
  private sending = false;

  constructor(private hub: Hub) {}

  point(hand: Vec, buttons: number): void {
    this.tag = (this.tag + 1) & TAGS;
    this.sentMs.set(this.tag, now());
    this.sentMs.delete((this.tag - KEPT_TAGS) & TAGS);
    this.send(encodePointer(hand, buttons, this.tag));
  }

  release(): void {
    this.send(encodeRelease());
  }

  /** Take all force away; the trial is repeated. */
  async stop(): Promise<void> {
    await fetch("stop", { method: "POST", body: "{}", keepalive: true });
  }

  feel(): Promise<void> {
    return Promise.resolve();
  }

  /** Refuse a request: a participant changes nothing. */
  ask<T>(): Promise<T> {
    return Promise.reject(new Error("a participant's page asks for nothing"));
  }

  drawn(): void {
    // nothing is drawn
  }

  /** Send the newest message; while one is under way, older ones that wait are left out. */
  private send(message: ArrayBuffer): void {
    this.next = message;
    if (!this.sending) void this.exchange();
  }

  private async exchange(): Promise<void> {
    this.sending = true;
    while (this.next) {
      const body = this.next;
      this.next = null;
      try {
        const state = parseState(await (await fetch("hand", { method: "POST", body })).arrayBuffer());
        if (!state) continue;
        this.latest = state;
        this.hub.tell("state", state);
      } catch {
        // the program releases a hand that falls silent, and the page's questions report that it is gone
      }
    }
    this.sending = false;
  }
}
