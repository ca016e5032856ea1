/** The websocket: states in, pointers and acknowledgements out, JSON for requests and messages. It reconnects by itself. */
import type { Hub } from "../hub";
import { language } from "../words/words";
import { token } from "./token";
import type { Events } from "./messages";
import { encodeAck, now, encodePointer, encodeRelease, parseState, TAGS, VERSION, type State, type Vec } from "./protocol";

const FIRST_PAUSE_MS = 250;
const LONGEST_PAUSE_MS = 4000;
const KEPT_TAGS = 512;
/** Milliseconds without an answer after which stop is sent by HTTP as well. */
const STOP_PATIENCE_MS = 300;
/** The program sends something every second; milliseconds of silence after which it counts as hanging. */
const SILENCE_MS = 2500;
const LOOK_EVERY_MS = 250;
/** Close code of the server for a page with a wrong key. */
const WRONG_KEY = 4401;

/** Fetch a file of the server. Throws if it is not there. */
export async function bulk(path: string, asked: Record<string, number> = {}, signal?: AbortSignal): Promise<Response> {
  const query = new URLSearchParams({ token, language, ...Object.fromEntries(Object.entries(asked).map(([k, v]) => [k, `${v}`])) });
  const response = await fetch(`${path}?${query}`, { signal });
  if (!response.ok) throw new Error(`${path}: ${response.status} ${await response.text()}`);
  return response;
}

interface Waiting {
  resolve: (value: unknown) => void;
  reject: (error: Error) => void;
}

export class Connection {
  latest: State | null = null;
  /** Send time of each pointer by its tag, to measure the time until its force is drawn. */
  readonly sentMs = new Map<number, number>();
  /** Time of the latest message, Unix seconds. */
  heard_s = 0;
  private tag = 0;
  private stopping = 0;
  private number = 0;
  private waiting = new Map<number, Waiting>();
  private socket: WebSocket | null = null;
  private pauseMs = FIRST_PAUSE_MS;
  private messageMs = 0;
  private isSilent = false;

  constructor(private hub: Hub) {
    this.connect();
    setInterval(() => this.look(), LOOK_EVERY_MS);
  }

  /** Send a request; rejects with the server's text if it is refused. */
  ask<T>(name: string, args: Record<string, unknown> = {}): Promise<T> {
    if (!this.open) return Promise.reject(new Error("the program is not there"));
    const number = ++this.number;
    this.socket!.send(JSON.stringify({ number, ask: name, ...args }));
    return new Promise<T>((done, refused) => {
      this.waiting.set(number, { resolve: done as (value: unknown) => void, reject: refused });
    });
  }

  /** Take all force away, also if the websocket hangs. */
  async stop(): Promise<void> {
    if (!this.open) return this.stopByHttp();
    clearTimeout(this.stopping);
    this.stopping = window.setTimeout(() => void this.stopByHttp().catch(() => undefined), STOP_PATIENCE_MS);
    return this.ask<void>("stop").finally(() => clearTimeout(this.stopping));
  }

  /** Switch forces on; a stop that was not answered yet no longer follows. */
  feel(): Promise<void> {
    clearTimeout(this.stopping);
    return this.ask<void>("feel");
  }

  private async stopByHttp(): Promise<void> {
    await fetch(`stop?token=${encodeURIComponent(token)}`, { method: "POST", keepalive: true });
  }

  point(hand: Vec, buttons: number): void {
    if (!this.open) return;
    this.tag = (this.tag + 1) & TAGS;
    this.sentMs.set(this.tag, now());
    this.sentMs.delete((this.tag - KEPT_TAGS) & TAGS);
    this.socket!.send(encodePointer(hand, buttons, this.tag));
  }

  release(): void {
    if (this.open) this.socket!.send(encodeRelease());
  }

  drawn(seq: number): void {
    if (this.open) this.socket!.send(encodeAck(seq));
  }

  /** Expect the end of the program: it is neither reported nor followed by another connection. */
  leave(): void {
    this.socket!.onclose = null;
  }

  private get open(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  private connect(): void {
    const { href } = new URL(`live?token=${encodeURIComponent(token)}&language=${language}`, location.href);
    const socket = new WebSocket(href.replace(/^http/, "ws"));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.pauseMs = FIRST_PAUSE_MS;
      this.messageMs = performance.now();
    };
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      this.messageMs = performance.now();
      if (this.isSilent) this.setSilent(false);
      if (typeof data === "string") this.onText(JSON.parse(data));
      else this.onState(data);
    };
    socket.onclose = ({ code }) => this.onClosed(code === WRONG_KEY ? "key" : undefined);
    this.socket = socket;
  }

  /** Report a program that hangs: its socket stays open. A page that slept itself first reads what has come meanwhile. */
  private look(): void {
    if (this.open && !this.isSilent && performance.now() - this.messageMs > SILENCE_MS) this.setSilent(true);
  }

  private setSilent(silent: boolean): void {
    this.isSilent = silent;
    this.hub.tell("silence", { event: "silence", at_s: now() / 1000, silent });
  }

  private onText(message: Events[keyof Events] & { event: string; number?: number; value?: unknown; text?: string }): void {
    const waits = message.number === undefined ? undefined : this.waiting.get(message.number);
    if (message.number !== undefined) {
      this.waiting.delete(message.number);
      if (message.event === "answer") waits?.resolve(message.value);
      else waits?.reject(new Error(message.text));
      return;
    }
    if (message.event === "hello" && (message as Events["hello"]).version !== VERSION) return this.abandon("version");
    this.hub.tell(message.event as keyof Events, message as never);
    const last = message.event === "hello" ? (message as Events["hello"]).history.at(-1) : message;
    this.heard_s = Math.max(this.heard_s, (last as { at_s?: number } | undefined)?.at_s ?? 0);
  }

  private onState(data: ArrayBuffer): void {
    const fresh = parseState(data);
    if (!fresh) return;
    this.latest = fresh;
    this.hub.tell("state", fresh);
    if (document.hidden) this.drawn(fresh.seq); // a hidden page draws nothing
  }

  /** Close the connection for good: the server is another version. */
  private abandon(why: "version"): void {
    this.socket!.onclose = () => this.onClosed(why);
    this.socket!.close();
  }

  private onClosed(forGood?: "key" | "version"): void {
    for (const { reject: refused } of this.waiting.values()) refused(new Error("the program is gone"));
    this.waiting.clear();
    this.isSilent = false;
    this.latest = null;
    this.hub.tell("gone", { event: "gone", at_s: now() / 1000 });
    if (forGood) return this.hub.tell("refused", { event: "refused", at_s: now() / 1000, why: forGood });
    setTimeout(() => this.connect(), this.pauseMs);
    this.pauseMs = Math.min(2 * this.pauseMs, LONGEST_PAUSE_MS);
  }
}
