/** A hand that explores a surface by keys, and all that is announced meanwhile: the page's own parts, and a clock that is
 * set by hand. */
import { HELD_MS, HeldKeys } from "kit/hand/keyboard";
import { clampToRim, nextPosition } from "kit/hand/motion";
import { PRESS_M } from "kit/hand/state";
import { Hub } from "kit/hub";
import type { Page } from "kit/page";
import type { Material, Meta } from "kit/server/messages";
import { FLAGS, type State, STATUS, type Vec } from "kit/server/protocol";
import { Announcer } from "kit/speech/announcer";
import { Narrator } from "kit/speech/narrator";
import { Grid } from "kit/surface/grid";
import { Scene } from "kit/surface/scene";

/** A picture of parts: rows from far to near; heights in metres, one a cell; a name and a material for each part. */
export interface Picture {
  rows: number;
  columns: number;
  extent_m: [number, number];
  heights_m: number[];
  labels: number[];
  names: string[] | null;
  materials: string[];
}

const STEP_MS = 16;
const NO_KEYS = { shiftKey: false, ctrlKey: false };

export function sceneOf({ rows, columns, extent_m, heights_m, labels, names, materials }: Picture): Scene {
  const [w, l] = extent_m;
  const grid = new Grid(Float32Array.from(heights_m), rows, columns, { left: -w / 2, far: l / 2, dx: w / columns, dy: l / rows });
  const kinds = [...new Set(materials)];
  const meta = {
    digest: "digest", name: "picture", rows, columns, extent_m, labels: materials.length, parts: names,
    height_m: heights_m.reduce(([low, high], each) => [Math.min(low, each), Math.max(high, each)], [Infinity, -Infinity]),
    materials: kinds.map((name) => ({ name }) as Material), levels: [{ step: 1, rows, columns }],
  } as unknown as Meta;
  return new Scene(meta, { grid, labels: Uint16Array.from(labels) }, Uint16Array.from(materials, (each) => kinds.indexOf(each)), null);
}

/** A page without a browser: its hub, announcements and narration, and a hand that keys move. */
export class Explorer {
  readonly said: string[] = [];
  readonly saidMs: number[] = [];
  readonly asked: [string, unknown][] = [];
  readonly hub = new Hub();
  readonly narrator: Narrator;
  readonly page: Page;
  nowMs = 0;
  down = false;
  at: Vec;
  private goal: [number, number] = [0, 0];
  private keys = new HeldKeys();
  private due: { atMs: number; act: () => void }[] = [];

  constructor(readonly scene: Scene) {
    const clock = { now: () => this.nowMs, after: (ms: number, act: () => void) => void this.due.push({ atMs: this.nowMs + ms, act }) };
    const announcer = new Announcer(({ text }) => (this.said.push(text), this.saidMs.push(this.nowMs)), clock);
    const element = { textContent: "" };
    globalThis.document ??= { getElementById: () => element, addEventListener: () => {} } as unknown as Document;
    this.page = {
      hub: this.hub, scene, net: { latest: null, ask: (...all: [string, unknown]) => (this.asked.push(all), Promise.resolve()) },
      canvas: { setAttribute: () => {}, clientWidth: 1000, ownerDocument: document }, view: { pixel_m: () => 1e-4 },
      hand: { leadTo: (x: number, y: number) => ((this.down = false), (this.goal = [x, y])) },
      say: (...all: Parameters<Announcer["say"]>) => announcer.say(...all),
    } as unknown as Page;
    this.narrator = new Narrator(this.page, clock);
    this.at = [0, 0, scene.height(0, 0) + 0.002];
  }

  /** Put the hand over a place, without a stroke. */
  put(x: number, y: number): void {
    this.goal = clampToRim(this.scene, x, y);
    this.at = [...this.goal, this.scene.height(...this.goal) + 0.002];
  }

  /** Hold a key for a time, or until the hand stands still. */
  hold(key: string, ms = Infinity): void {
    const [x, y, z] = this.keys.down(key, NO_KEYS, this.nowMs)!;
    this.move(x, y, z);
    for (let passed = 0; passed < ms; passed += STEP_MS) {
      const before = this.at;
      this.step();
      if (passed > 2 * HELD_MS && before.every((part, axis) => part === this.at[axis])) break;
    }
    this.keys.up(key, NO_KEYS);
  }

  tap(key: string): void {
    this.hold(key, STEP_MS);
    this.rest(200);
  }

  rest(ms: number): void {
    for (let passed = 0; passed < ms; passed += STEP_MS) this.step();
  }

  /** Wait until nothing was announced for a time that every sentence fits into. */
  listen(quietMs = 4500): void {
    do this.rest(500);
    while (this.nowMs - (this.saidMs.at(-1) ?? -Infinity) < quietMs);
  }

  private move(x: number, y: number, z: number): void {
    if (z === 0) this.goal = clampToRim(this.scene, this.goal[0] + x, this.goal[1] + y);
  }

  private step(): void {
    this.nowMs += STEP_MS;
    this.move(...(this.keys.way(STEP_MS / 1000, this.nowMs) as Vec));
    this.at = nextPosition(this.at, { over: this.goal, gapM: this.down ? -PRESS_M.first : 0.002 }, STEP_MS / 1000, this.scene);
    this.tell(this.at[2] < this.scene.height(this.at[0], this.at[1]) ? FLAGS.TOUCHING : 0);
    for (const each of this.due.filter(({ atMs }) => atMs <= this.nowMs)) {
      this.due = this.due.filter((other) => other !== each);
      each.act();
    }
  }

  /** Tell a state of the loop. */
  tell(flags: number, hand: Vec = this.at): void {
    const state = { status: STATUS.RUNNING | STATUS.HOLDING, flags, hand, force: [0, 0, 1.5], sampleMs: this.nowMs } as unknown as State;
    (this.page.net as { latest: State }).latest = state;
    this.hub.tell("state", state);
  }
}

/** Explore a picture by strokes to and fro, half of them from left to right, half from near to far; return what was said. */
export function explore(picture: Picture, strokes: number): string[] {
  const scene = sceneOf(picture);
  const [w, l] = picture.extent_m;
  const hand = new Explorer(scene);
  const half = strokes / 2;
  for (const [ways, put] of [
    [["ArrowRight", "ArrowLeft"], (share: number, k: number) => hand.put(k % 2 ? w / 2 : -w / 2, l * (share - 0.5))],
    [["ArrowUp", "ArrowDown"], (share: number, k: number) => hand.put(w * (share - 0.5), k % 2 ? l / 2 : -l / 2)],
  ] as const)
    for (let k = 0; k < half; k++) {
      put((k + 0.5) / half, k);
      hand.down = true;
      hand.rest(400);
      hand.hold(ways[k % 2]!);
      hand.listen();
      hand.down = false;
      hand.rest(600);
    }
  return hand.said;
}
