/** The ruler: two places on the surface, and what lies between them. */
import type { Page } from "../../page";
import type { Vec } from "../../server/protocol";
import { on } from "../../shortcuts";
import { t } from "../words";
import { COLOURS } from "../colours";
import { Draped } from "./draped_line";
import { Handle, STEP_M } from "./handle";
import { measure, type Measured } from "./measurement";
import type { Picked } from "../picking";
import { plus } from "../../contact/vectors";

export class Ruler implements Picked {
  /** None, one, or both. */
  ends: Vec[] = [];
  measured: Measured | null = null;
  /** Called when anything of it changed. */
  changed: () => void = () => {};
  private line: Draped;
  private label = document.createElement("div");

  constructor(private page: Page) {
    this.line = new Draped(page.view, 1, COLOURS.frame, true);
    this.label.className = "ruler-label";
    page.overlay.stay(this.label, () => this.middle());
    for (const end of [0, 1]) {
      const grasped = {
        at: () => this.ends[end] ?? null,
        drag: (to: Vec) => this.put(end, to),
        nudge: (right: number, away: number) => this.nudge(end, right * STEP_M, away * STEP_M),
        done: () => this.tell(),
      };
      new Handle(page, "round", t(end ? "rulerEnd" : "rulerStart"), grasped).element.dataset.sign = "AB"[end];
    }
    page.hub.on("shown", () => this.again());
    on("measure here", () => this.here());
    on("remove ruler", () => this.remove());
  }

  /** Whether clicks are its own. */
  get picking(): boolean {
    return this.page.overlay.picking.busy === this;
  }

  toggle(): void {
    this.page.overlay.picking.take(this.picking ? null : this);
    this.changed();
  }

  begin(at: Vec): void {
    this.next(at);
  }

  drag(at: Vec): void {
    if (this.ends.length === 2) this.put(1, at);
    else if (Math.hypot(at[0] - this.ends[0][0], at[1] - this.ends[0][1]) > STEP_M) this.put(1, at);
  }

  left(): void {
    this.changed();
  }

  /** The next place: the first, the second, or the first of another measurement. */
  next(at: Vec): void {
    if (this.ends.length === 2) this.ends = [];
    this.put(this.ends.length, at);
    this.tell();
  }

  put(end: number, at: Vec): void {
    this.ends[end] = at;
    this.again();
  }

  remove(): void {
    this.ends = [];
    this.again();
  }

  /** The next place is where the hand is, or in the middle of what is seen. */
  here(): void {
    const { scene, overlay, view } = this.page;
    const live = overlay.live?.seen ? overlay.live : null;
    const [x, y] = live ? live.hand : view.eye.pose.target;
    if (scene) this.next(scene.on(x, y));
  }

  private tell(): void {
    if (this.measured) this.page.say(t("measured", { mm: (1000 * this.measured.straightM).toFixed(2) }));
    else if (this.ends.length) this.page.say(t("rulerBegun"));
  }

  private nudge(end: number, right: number, away: number): void {
    const { scene } = this.page;
    const at = plus(this.ends[end], [right, away, 0]);
    if (scene) this.put(end, scene.on(at[0], at[1]));
  }

  /** Measured again: an end moved, or the surface is another. */
  private again(): void {
    const { scene, overlay } = this.page;
    if (scene) this.ends = this.ends.map(([x, y]) => scene.on(x, y));
    const [from, to] = this.ends;
    const whole = scene !== null && from !== undefined && to !== undefined;
    this.measured = whole ? measure(scene, from, to, scene.meta.extent_m[0] / scene.meta.columns) : null;
    this.line.visible = whole;
    if (whole && this.measured) {
      this.line.put(scene, this.ends);
      this.label.textContent = t("length", { mm: (1000 * this.measured.straightM).toFixed(2) });
    }
    overlay.changed = true;
    this.changed();
  }

  private middle(): Vec | null {
    const [from, to] = this.ends;
    if (!to || !this.page.scene) return null;
    return this.page.scene.on((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  }
}
