/** This page's hand: its goal, its motion, and the messages that keep it alive. Mouse, keys, fingers and game pad move it. */
import type { Page, PageHand } from "../page";
import type { Values } from "../server/messages";
import type { Vec } from "../server/protocol";
import { clamp, HOVER_M, nextPosition, clampToRim, type Goal } from "./motion";
import { findPartCentres, type Part } from "./part_centres";
import { type Mover, PRESS_M } from "./state";
import { t } from "./words";
import { decimal } from "../words/words";

/** Interval of messages for a hand at rest, ms: the server releases it after 100 ms of silence. */
const ALIVE_MS = 30;
/** Interval of the hand's steps, ms. */
const STEP_MS = 15;
/** Longest step, seconds: after a pause of the page the hand does not leap. */
const LONGEST_STEP_S = 0.05;
/** Height over the surface of a hand that does not press, metres; below 0 it penetrates. */
const GAP_M = { least: -PRESS_M.most, most: 0.03 };

export class Hand implements PageHand {
  /** Position; null while nothing moves it. */
  at: Vec | null = null;
  down = false;
  /** Penetration in metres of the hand: a magnified region has smaller ones. */
  pressM = PRESS_M.first;
  isFree = false;
  /** True if this tab's hand is active. */
  holding = false;
  nobodyHolds = false;
  /** True if the server is connected. */
  there = false;
  /** True if the loop uses another device. */
  rests = false;
  by: Mover | null = null;
  /** Time of the last move by a key. */
  keyedMs = -Infinity;
  /** True if a game pad is connected. */
  pads = false;
  /** Magnitude of the force, newtons. */
  feltN = 0;
  private goal: { over: [number, number] } | { at: Vec } | null = null;
  private gapM = HOVER_M;
  private movers: ((seconds: number) => void)[] = [];
  private steppedMs = performance.now();
  private sentMs = -Infinity;
  private centres: { scene: unknown; parts: Part[]; next: number } = { scene: null, parts: [], next: -1 };

  constructor(private page: Pick<Page, "hub" | "net" | "scene" | "document" | "say">) {
    setInterval(() => this.step(), STEP_MS);
    this.releaseWhenUnattended();
    this.subscribe();
  }

  /** Magnification of the picture for the hand: it moves that much slower and gentler. */
  get magnification(): number {
    const mapping = (this.page.document?.values?.mapping ?? {}) as Values;
    return magnificationOf(mapping, this.page.scene?.meta.extent_m ?? [1, 1]);
  }

  /** Add a mover, called in each step with the seconds that passed. */
  addMover(mover: (seconds: number) => void): void {
    this.movers.push(mover);
  }

  /** Move over a place of the surface, pressing or not. */
  moveOver(by: Mover, x: number, y: number, down: boolean): void {
    if (!this.mayMove(by, down)) return;
    if (this.isFree) this.goal = { at: [x, y, this.height(x, y, down)] };
    else this.goal = { over: [x, y] };
    this.down = down;
    this.step();
  }

  /** Move to a place in space. */
  moveTo(by: Mover, at: Vec): void {
    if (!this.mayMove(by, false)) return;
    this.goal = { at };
    this.step();
  }

  /** Move by a distance in metres of the hand. */
  moveBy(by: Mover, x: number, y: number, z: number): void {
    if (!this.page.scene || !this.mayMove(by, this.down)) return;
    const goal = this.goalOrDefault();
    const scale = this.magnification;
    if ("at" in goal) this.goal = { at: [goal.at[0] + x / scale, goal.at[1] + y / scale, goal.at[2] + z / scale] };
    else {
      this.goal = { over: clampToRim(this.page.scene, goal.over[0] + x / scale, goal.over[1] + y / scale) };
      this.changeHeight(z);
    }
    if (z) this.page.say(() => this.depthInWords(), { topic: "hand" });
  }

  /** Move deeper, whether it touches or not. */
  deeper(by: Mover, metres: number): void {
    if (this.goal && this.mayMove(by, this.down)) this.moveBy(by, 0, 0, -metres);
  }

  /** Press into the surface, or lift. */
  press(by: Mover, down: boolean): void {
    if (!this.page.scene || !this.mayMove(by, down)) return;
    const goal = this.goalOrDefault();
    this.goal = "at" in goal ? { at: [goal.at[0], goal.at[1], this.height(goal.at[0], goal.at[1], down)] } : goal;
    this.down = down;
    this.gapM = HOVER_M;
    this.step();
  }

  /** Set the penetration as a share of the greatest. */
  pressShare(share: number): void {
    this.pressM = PRESS_M.least + clamp(share, 0, 1) * (PRESS_M.most - PRESS_M.least);
  }

  toMiddle(by: Mover): void {
    this.liftTo(by, 0, 0);
    this.page.hub.tell("led", { label: null });
  }

  /** Move to the centre of the next part, or of the previous one. */
  toNextPart(by: Mover, step: 1 | -1): void {
    const { scene } = this.page;
    if (!scene) return;
    if (this.centres.scene !== scene)
      this.centres = { scene, parts: findPartCentres((x, y) => scene.label(x, y), scene.meta.extent_m), next: step > 0 ? -1 : 0 };
    const { parts: all, next } = this.centres;
    if (!all.length) return this.page.say(t("noParts"));
    this.centres.next = (next + step + all.length) % all.length;
    const { at, label } = all[this.centres.next]!;
    this.liftTo(by, ...at);
    this.page.hub.tell("led", { label });
  }

  leadTo(x: number, y: number): void {
    this.liftTo("keys", x, y);
  }

  /** Move freely in space, or over the surface. */
  free(on: boolean): void {
    this.isFree = on;
    this.down = false;
    this.gapM = HOVER_M;
    if (this.goal) {
      const [x, y] = "at" in this.goal ? this.goal.at : this.goal.over;
      this.goal = on ? { at: this.at ?? [x, y, this.height(x, y, false)] } : { over: [x, y] };
    }
    this.page.say(t(on ? "inSpace" : "overSurface"), { topic: "hand", asked: true });
    this.notify();
  }

  /** Return a coordinate of the goal in space. */
  goalM(axis: 0 | 1 | 2): number {
    return this.goal && "at" in this.goal ? this.goal.at[axis] : (this.at?.[axis] ?? 0);
  }

  /** Release the device: no force. by: only if this mover moves the hand. */
  release(by: Mover | null = null): void {
    if (!this.goal || (by && by !== this.by)) return;
    this.goal = this.at = this.by = null;
    this.down = false;
    this.gapM = HOVER_M;
    this.page.net.release();
    this.notify();
  }

  /** Make this tab's hand the active one. */
  take(): void {
    void this.page.net.ask("hold").catch(() => undefined); // the header shows that the program is gone
  }

  stop(): void {
    this.release();
    void this.page.net.stop().catch(() => undefined);
  }

  private mayMove(by: Mover, down: boolean): boolean {
    if (by === "keys") this.keyedMs = performance.now();
    if (!this.page.scene) return false;
    if (!this.holding) {
      if (down && !this.down) this.request();
      return false;
    }
    if (this.by !== by) {
      this.by = by;
      this.notify();
    }
    return true;
  }

  /** Take a hand that no tab holds; one that another tab holds is taken by its button alone. */
  private request(): void {
    if (this.nobodyHolds) this.take();
    else this.page.say(t("another"));
  }

  private liftTo(by: Mover, x: number, y: number): void {
    if (!this.page.scene) return;
    this.press(by, false);
    this.moveOver(by, x, y, false);
  }

  private goalOrDefault(): { over: [number, number] } | { at: Vec } {
    return this.goal ?? (this.isFree ? { at: [0, 0, this.height(0, 0, false)] } : { over: [0, 0] });
  }

  /** Return how deep the hand presses, or how high it is, when it has stopped changing. */
  private depthInWords(): string {
    const { goal } = this;
    if (!goal) return "";
    if ("at" in goal) return t("level", { mm: decimal(1000 * goal.at[2], 1) });
    if (!this.down) return t(this.gapM < 0 ? "deepUnpressed" : "above", { mm: decimal(1000 * Math.abs(this.gapM), 1) });
    const mm = decimal(1000 * this.pressM, 1);
    if (this.pressM >= PRESS_M.most) return t("deepest", { mm });
    return t(this.pressM <= PRESS_M.least ? "shallowest" : "deep", { mm });
  }

  private changeHeight(z: number): void {
    if (this.down) this.pressM = clamp(this.pressM - z, PRESS_M.least, PRESS_M.most);
    else this.gapM = clamp(this.gapM + z, GAP_M.least, GAP_M.most);
  }

  private height(x: number, y: number, down: boolean): number {
    const { scene } = this.page;
    return scene ? scene.height(...clampToRim(scene, x, y)) + (down ? -this.pressM : HOVER_M) / this.magnification : 0;
  }

  /** Step towards the goal and send the position, also while it rests or the server released it. */
  private step(): void {
    const nowMs = performance.now();
    const seconds = Math.min((nowMs - this.steppedMs) / 1000, LONGEST_STEP_S);
    if (seconds < 0.001) return; // several mouse events at once
    this.steppedMs = nowMs;
    for (const mover of this.movers) mover(seconds);
    const { scene, net } = this.page;
    if (!this.goal || !scene || !this.holding || this.rests) return;
    const before = this.at;
    const scale = this.magnification;
    const gap = this.down ? Math.min(-this.pressM, this.gapM) : this.gapM;
    const goal: Goal = "at" in this.goal ? this.goal : { over: this.goal.over, gapM: gap / scale };
    this.at = nextPosition(before, goal, seconds, scene, scale);
    if (!this.at.every(Number.isFinite)) return this.release(); // a surface without any height
    const still = before?.every((part, i) => part === this.at![i]);
    if (still && nowMs - this.sentMs < ALIVE_MS) return;
    this.sentMs = nowMs;
    net.point(this.at, this.down ? 1 : 0);
  }

  private releaseWhenUnattended(): void {
    const release = (): void => this.release();
    document.addEventListener("visibilitychange", () => document.hidden && release());
    for (const name of ["pagehide", "blur"]) window.addEventListener(name, release);
    document.addEventListener("freeze", release);
    document.addEventListener("keydown", (event) => event.key === "Escape" && release(), { capture: true });
    for (const name of ["gamepadconnected", "gamepaddisconnected"])
      window.addEventListener(name, () => {
        this.pads = navigator.getGamepads().some((each) => each?.connected);
        this.notify();
      });
  }

  private subscribe(): void {
    const { hub } = this.page;
    hub.on("holding", ({ holding, free }) => {
      if (!holding) this.release();
      this.holding = holding;
      this.nobodyHolds = free;
      this.there = true;
      this.notify();
    });
    hub.on("gone", () => {
      this.release();
      this.holding = this.nobodyHolds = this.there = false;
      this.notify();
    });
    hub.on("loop", ({ running, own_hand }) => {
      if (own_hand !== undefined) this.rests = !own_hand;
      if (!running) this.release();
      this.notify();
    });
    hub.on("state", ({ force }) => (this.feltN = Math.hypot(...force)));
  }

  private notify(): void {
    this.page.hub.tell("hand", this);
  }
}

/** Return the magnification of the server's mapping, for a hand whose workspace is as large as the picture. */
export function magnificationOf({ scale, region_m }: Values, [w, l]: [number, number]): number {
  if (typeof scale === "number") return scale;
  if (!Array.isArray(region_m)) return 1;
  const [, , width, length] = region_m as number[];
  return Math.min(w / width!, l / length!);
}
