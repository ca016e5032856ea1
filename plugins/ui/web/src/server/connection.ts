/** The one websocket: states in, pointers and acknowledgements out, JSON for what is rare. It comes back by itself. */
import type { Hub } from "../hub";
import { token } from "./token";
import type { Events } from "./messages";
import { ack, now, pointer, release, state, TAGS, VERSION, type State, type Vec } from "./protocol";

const FIRST_PAUSE_MS = 250;
const LONGEST_PAUSE_MS = 4000;
const KEPT_TAGS = 512;
/** After so long without an answer, stop is asked for beside the websocket as well. */
const STOP_PATIENCE_MS = 300;
/** How the server closes the websocket of a page whose key is not its own. */
const WRONG_KEY = 4401;

export { token };

/** What the server keeps under an address. Throws if it is not there. */
export async function bulk(path: string, asked: Record<string, number> = {}, signal?: AbortSignal): Promise<Response> {
  const query = new URLSearchParams({ token, ...Object.fromEntries(Object.entries(asked).map(([k, v]) => [k, `${v}`])) });
  const response = await fetch(`${path}?${query}`, { signal });
  if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  return response;
}

interface Waiting {
  done: (value: unknown) => void;
  refused: (error: Error) => void;
}

export class Net {
  latest: State | null = null;
  /** When each pointer was sent, by its tag: how long until its force is drawn. */
  readonly sentMs = new Map<number, number>();
  /** When the newest event was said that this page heard. */
  heard_s = 0;
  private tag = 0;
  private stopping = 0;
  private number = 0;
  private waiting = new Map<number, Waiting>();
  private socket: WebSocket | null = null;
  private pauseMs = FIRST_PAUSE_MS;

  constructor(private hub: Hub) {
    this.connect();
  }

  /** Ask the server for something; rejects with its words where it refuses. */
  ask<T>(name: string, told: Record<string, unknown> = {}): Promise<T> {
    if (!this.open) return Promise.reject(new Error("the program is not there"));
    const number = ++this.number;
    this.socket!.send(JSON.stringify({ number, ask: name, ...told }));
    return new Promise<T>((done, refused) => {
      this.waiting.set(number, { done: done as (value: unknown) => void, refused });
    });
  }

  /** No force, whatever else goes on, and though the websocket may hang. */
  async stop(): Promise<void> {
    if (!this.open) return this.stopBeside();
    clearTimeout(this.stopping);
    this.stopping = window.setTimeout(() => void this.stopBeside().catch(() => undefined), STOP_PATIENCE_MS);
    return this.ask<void>("stop").finally(() => clearTimeout(this.stopping));
  }

  /** Feel again: a stop from before that was not answered yet does not come after it. */
  feel(): Promise<void> {
    clearTimeout(this.stopping);
    return this.ask<void>("feel");
  }

  private async stopBeside(): Promise<void> {
    await fetch(`/stop?token=${encodeURIComponent(token)}`, { method: "POST", keepalive: true });
  }

  point(hand: Vec, buttons: number): void {
    if (!this.open) return;
    this.tag = (this.tag + 1) & TAGS;
    this.sentMs.set(this.tag, now());
    this.sentMs.delete((this.tag - KEPT_TAGS) & TAGS);
    this.socket!.send(pointer(hand, buttons, this.tag));
  }

  release(): void {
    if (this.open) this.socket!.send(release());
  }

  drawn(seq: number): void {
    if (this.open) this.socket!.send(ack(seq));
  }

  private get open(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  private connect(): void {
    const socket = new WebSocket(`ws://${location.host}/live?token=${encodeURIComponent(token)}`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => (this.pauseMs = FIRST_PAUSE_MS);
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) =>
      typeof data === "string" ? this.hear(JSON.parse(data)) : this.take(data);
    socket.onclose = ({ code }) => this.lost(code === WRONG_KEY ? "key" : undefined);
    this.socket = socket;
  }

  private hear(said: Events[keyof Events] & { event: string; number?: number; value?: unknown; text?: string }): void {
    const waits = said.number === undefined ? undefined : this.waiting.get(said.number);
    if (said.number !== undefined) {
      this.waiting.delete(said.number);
      if (said.event === "answer") waits?.done(said.value);
      else waits?.refused(new Error(said.text));
      return;
    }
    if (said.event === "hello" && (said as Events["hello"]).version !== VERSION) return this.leave("version");
    this.hub.tell(said.event as keyof Events, said as never);
    const last = said.event === "hello" ? (said as Events["hello"]).history.at(-1) : said;
    this.heard_s = Math.max(this.heard_s, (last as { at_s?: number } | undefined)?.at_s ?? 0);
  }

  private take(data: ArrayBuffer): void {
    const fresh = state(data);
    if (!fresh) return;
    this.latest = fresh;
    this.hub.tell("state", fresh);
    if (document.hidden) this.drawn(fresh.seq); // nothing is drawn then
  }

  /** This page cannot go on with that program. */
  private leave(why: "version"): void {
    this.socket!.onclose = () => this.lost(why);
    this.socket!.close();
  }

  private lost(forGood?: "key" | "version"): void {
    for (const { refused } of this.waiting.values()) refused(new Error("the program is gone"));
    this.waiting.clear();
    this.latest = null;
    this.hub.tell("gone", { event: "gone", at_s: now() / 1000 });
    if (forGood) return this.hub.tell("refused", { event: "refused", at_s: now() / 1000, why: forGood });
    setTimeout(() => this.connect(), this.pauseMs);
    this.pauseMs = Math.min(2 * this.pauseMs, LONGEST_PAUSE_MS);
  }
}
