/** The hand that this page moves: where it is wanted, where it is, and that it lives. What moves it stands beside. */
import { keys } from "./keyboard";
import { clamp, HOVER_M, moved, within, type Goal } from "./motion";
import { mouse } from "./mouse";
import { pad } from "./game_pad";
import { parts, type Part } from "./part_centres";
import { touch } from "./fingers";
import type { Values } from "../server/messages";
import type { Page } from "../page";
import type { Vec } from "../server/protocol";
import { t } from "./words";

export type Mover = "mouse" | "keys" | "touch" | "pad";

/** So often the server hears that the page lives: it lets go after 100 ms of silence. */
const ALIVE_MS = 30;
/** So often the hand goes on. */
const STEP_MS = 15;
/** After a pause of the page the hand goes on where it was, and does not leap. */
const LONGEST_STEP_S = 0.05;
/** How deep it presses; of a hand that does not, how high it is, below 0 in the surface. */
export const PRESS_M = { first: 0.0015, least: 0.0002, most: 0.006 };
const GAP_M = { least: -PRESS_M.most, most: 0.03 };

export class Hand {
  /** Where it is; null while nothing moves it. */
  at: Vec | null = null;
  down = false;
  /** In metres of the hand: a region that is felt enlarged has smaller ones. */
  pressM = PRESS_M.first;
  isFree = false;
  /** Whether this tab's hand is the one that is felt; whether none is. */
  holding = false;
  nobodyHolds = false;
  /** Whether the program is there. */
  there = false;
  /** Whether the loop has another device. */
  rests = false;
  by: Mover | null = null;
  /** When a key last moved it. */
  keyedMs = -Infinity;
  /** Whether a game pad was there. */
  pads = false;
  /** The force on it. */
  feltN = 0;
  private goal: { over: [number, number] } | { at: Vec } | null = null;
  private gapM = HOVER_M;
  private movers: ((seconds: number) => void)[] = [];
  private steppedMs = performance.now();
  private sentMs = -Infinity;
  private known: { scene: unknown; parts: Part[]; next: number } = { scene: null, parts: [], next: -1 };

  constructor(readonly page: Page) {
    for (const each of [mouse, touch, keys, pad]) each(this);
    setInterval(() => this.step(), STEP_MS);
    this.letGoWhenNobodyLooks();
    this.hear();
  }

  /** How much larger than in the picture the hand finds everything: it is as much slower and gentler. */
  get enlarged(): number {
    const mapping = (this.page.document?.values?.mapping ?? {}) as Values;
    return enlargement(mapping, this.page.scene?.meta.extent_m ?? [1, 1]);
  }

  /** Somebody who moves it on and on: called with the seconds that passed. */
  moves(mover: (seconds: number) => void): void {
    this.movers.push(mover);
  }

  /** Over this place of the surface, pressing or not. */
  over(by: Mover, x: number, y: number, down: boolean): void {
    if (!this.may(by, down)) return;
    if (this.isFree) this.goal = { at: [x, y, this.height(x, y, down)] };
    else this.goal = { over: [x, y] };
    this.down = down;
    this.step();
  }

  /** At this place in space. */
  at3(by: Mover, at: Vec): void {
    if (!this.may(by, false)) return;
    this.goal = { at };
    this.step();
  }

  /** By so much from where it is wanted, in metres of the hand. */
  go(by: Mover, x: number, y: number, z: number): void {
    if (!this.page.scene || !this.may(by, this.down)) return;
    const goal = this.wanted();
    const scale = this.enlarged;
    if ("at" in goal) this.goal = { at: [goal.at[0] + x / scale, goal.at[1] + y / scale, goal.at[2] + z / scale] };
    else {
      this.goal = { over: within(this.page.scene, goal.over[0] + x / scale, goal.over[1] + y / scale) };
      this.rise(z);
    }
  }

  /** The wheel: deeper, whether it touches or not. */
  deeper(by: Mover, metres: number): void {
    if (this.goal && this.may(by, this.down)) this.go(by, 0, 0, -metres);
  }

  /** Down into the surface, or off it. */
  put(by: Mover, down: boolean): void {
    if (!this.page.scene || !this.may(by, down)) return;
    const goal = this.wanted();
    this.goal = "at" in goal ? { at: [goal.at[0], goal.at[1], this.height(goal.at[0], goal.at[1], down)] } : goal;
    this.down = down;
    this.gapM = HOVER_M;
    this.step();
  }

  /** How hard it presses, as a share of the most. */
  pressShare(share: number): void {
    this.pressM = PRESS_M.least + clamp(share, 0, 1) * (PRESS_M.most - PRESS_M.least);
  }

  toMiddle(by: Mover): void {
    this.lift(by, 0, 0);
    this.page.say(t("inTheMiddle"));
  }

  /** To the widest place of the next part, or the one before. */
  toNextPart(by: Mover, step: 1 | -1): void {
    const { scene } = this.page;
    if (!scene) return;
    if (this.known.scene !== scene)
      this.known = { scene, parts: parts((x, y) => scene.label(x, y), scene.meta.extent_m), next: step > 0 ? -1 : 0 };
    const { parts: all, next } = this.known;
    if (!all.length) return this.page.say(t("noParts"));
    this.known.next = (next + step + all.length) % all.length;
    const { at } = all[this.known.next]!;
    this.lift(by, ...at);
    const called = scene.part(...at);
    const name = (called && `${called}, `) + (scene.material(...at)?.name ?? t("noMaterial"));
    this.page.say(t("part", { number: this.known.next + 1, of: all.length, name }));
  }

  /** In space, wherever it is moved to; or over the surface. */
  free(on: boolean): void {
    this.isFree = on;
    this.down = false;
    this.gapM = HOVER_M;
    if (this.goal) {
      const [x, y] = "at" in this.goal ? this.goal.at : this.goal.over;
      this.goal = on ? { at: this.at ?? [x, y, this.height(x, y, false)] } : { over: [x, y] };
    }
    this.page.say(t(on ? "inSpace" : "overSurface"));
    this.tell();
  }

  /** A coordinate of where it is wanted in space. */
  goalM(axis: 0 | 1 | 2): number {
    return this.goal && "at" in this.goal ? this.goal.at[axis] : (this.at?.[axis] ?? 0);
  }

  /** Let go: nothing is felt. by: whoever does not move it, cannot. */
  release(by: Mover | null = null): void {
    if (!this.goal || (by && by !== this.by)) return;
    this.goal = this.at = this.by = null;
    this.down = false;
    this.gapM = HOVER_M;
    this.page.net.release();
    this.tell();
  }

  /** This tab's hand is to be felt. */
  take(): void {
    void this.page.net.ask("hold").catch(() => undefined); // the head of the page says that the program is gone
  }

  stop(): void {
    this.release();
    void this.page.net.stop().catch(() => undefined);
  }

  private may(by: Mover, down: boolean): boolean {
    if (by === "keys") this.keyedMs = performance.now();
    if (!this.page.scene) return false;
    if (!this.holding) {
      if (down && !this.down) this.askForIt();
      return false;
    }
    if (this.by !== by) {
      this.by = by;
      this.tell();
    }
    return true;
  }

  /** Who presses where nobody holds the hand, wants it; one that is held is taken by its button alone. */
  private askForIt(): void {
    if (this.nobodyHolds) this.take();
    else this.page.say(t("another"));
  }

  private lift(by: Mover, x: number, y: number): void {
    if (!this.page.scene) return;
    this.put(by, false);
    this.over(by, x, y, false);
  }

  private wanted(): { over: [number, number] } | { at: Vec } {
    return this.goal ?? (this.isFree ? { at: [0, 0, this.height(0, 0, false)] } : { over: [0, 0] });
  }

  private rise(z: number): void {
    if (this.down) this.pressM = clamp(this.pressM - z, PRESS_M.least, PRESS_M.most);
    else this.gapM = clamp(this.gapM + z, GAP_M.least, GAP_M.most);
  }

  private height(x: number, y: number, down: boolean): number {
    const { scene } = this.page;
    return scene ? scene.height(...within(scene, x, y)) + (down ? -this.pressM : HOVER_M) / this.enlarged : 0;
  }

  /** Go on towards where it is wanted, and say where it is; also where it stands still, or the server lets go. */
  private step(): void {
    const nowMs = performance.now();
    const seconds = Math.min((nowMs - this.steppedMs) / 1000, LONGEST_STEP_S);
    if (seconds < 0.001) return; // several events of a mouse at once
    this.steppedMs = nowMs;
    for (const mover of this.movers) mover(seconds);
    const { scene, net } = this.page;
    if (!this.goal || !scene || !this.holding || this.rests) return;
    const before = this.at;
    const scale = this.enlarged;
    const gap = this.down ? Math.min(-this.pressM, this.gapM) : this.gapM;
    const goal: Goal = "at" in this.goal ? this.goal : { over: this.goal.over, gapM: gap / scale };
    this.at = moved(before, goal, seconds, scene, scale);
    if (!this.at.every(Number.isFinite)) return this.release(); // a surface that is nowhere there
    const still = before?.every((part, i) => part === this.at![i]);
    if (still && nowMs - this.sentMs < ALIVE_MS) return;
    this.sentMs = nowMs;
    net.point(this.at, this.down ? 1 : 0);
  }

  private letGoWhenNobodyLooks(): void {
    const release = (): void => this.release();
    document.addEventListener("visibilitychange", () => document.hidden && release());
    for (const name of ["pagehide", "blur"]) window.addEventListener(name, release);
    document.addEventListener("freeze", release);
    document.addEventListener("keydown", (event) => event.key === "Escape" && release(), { capture: true });
    for (const name of ["gamepadconnected", "gamepaddisconnected"])
      window.addEventListener(name, () => {
        this.pads = navigator.getGamepads().some((each) => each?.connected);
        this.tell();
      });
  }

  private hear(): void {
    const { hub } = this.page;
    hub.on("holding", ({ holding, free }) => {
      if (!holding) this.release();
      this.holding = holding;
      this.nobodyHolds = free;
      this.there = true;
      this.tell();
    });
    hub.on("gone", () => {
      this.release();
      this.holding = this.nobodyHolds = this.there = false;
      this.tell();
    });
    hub.on("loop", ({ running, own_hand }) => {
      if (own_hand !== undefined) this.rests = !own_hand;
      if (!running) this.release();
      this.tell();
    });
    hub.on("state", ({ force }) => (this.feltN = Math.hypot(...force)));
  }

  private tell(): void {
    this.page.hub.tell("hand", this);
  }
}

/** As the server's mapping has it, for a hand whose own space is as large as the picture. */
export function enlargement({ scale, region_m }: Values, [w, l]: [number, number]): number {
  if (typeof scale === "number") return scale;
  if (!Array.isArray(region_m)) return 1;
  const [, , width, length] = region_m as number[];
  return Math.min(w / width!, l / length!);
}
