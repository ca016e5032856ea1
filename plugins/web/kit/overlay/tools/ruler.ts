/** The ruler: measures between two places on the surface. */
import type { Page, PointerTool } from "../../page";
import type { Vec } from "../../server/protocol";
import { on } from "../../shortcuts";
import { t } from "../words";
import { COLOURS } from "../colours";
import { DrapedLine } from "./draped_line";
import { Handle, STEP_M } from "./handle";
import { measure, type Measurement } from "./measurement";
import { plus } from "../../contact/vectors";

export class Ruler implements PointerTool {
  /** Ends so far: none, one, or both. */
  ends: Vec[] = [];
  measured: Measurement | null = null;
  /** Called when the ruler changed. */
  onChange: () => void = () => {};
  private line: DrapedLine;
  private label = document.createElement("div");

  constructor(private page: Pick<Page, "hub" | "view" | "overlay" | "scene" | "say">) {
    this.line = new DrapedLine(page.view, 1, COLOURS.frame, true);
    this.label.className = "ruler-label";
    page.overlay.stay(this.label, () => this.middle());
    for (const end of [0, 1]) {
      const grasped = {
        at: () => this.ends[end] ?? null,
        drag: (to: Vec) => this.setEnd(end, to),
        nudge: (right: number, away: number) => this.nudge(end, right * STEP_M, away * STEP_M),
        done: () => this.announce(),
      };
      new Handle(page, "round", t(end ? "rulerEnd" : "rulerStart"), grasped).element.dataset.sign = "AB"[end];
    }
    page.hub.on("shown", () => this.measureAgain());
    on("measure here", () => this.addHere());
    on("remove ruler", () => this.remove());
  }

  /** True while clicks set the ruler's ends. */
  get picking(): boolean {
    return this.page.overlay.picking.busy === this;
  }

  toggle(): void {
    this.page.overlay.picking.take(this.picking ? null : this);
    this.onChange();
  }

  begin(at: Vec): void {
    this.addEnd(at);
  }

  drag(at: Vec): void {
    if (this.ends.length === 2) this.setEnd(1, at);
    else if (Math.hypot(at[0] - this.ends[0][0], at[1] - this.ends[0][1]) > STEP_M) this.setEnd(1, at);
  }

  left(): void {
    this.onChange();
  }

  /** Add an end: the first, the second, or the first of another measurement. */
  addEnd(at: Vec): void {
    if (this.ends.length === 2) this.ends = [];
    this.setEnd(this.ends.length, at);
    this.announce();
  }

  setEnd(end: number, at: Vec): void {
    this.ends[end] = at;
    this.measureAgain();
  }

  remove(): void {
    this.ends = [];
    this.measureAgain();
  }

  /** Add an end at the hand, or at the middle of the view. */
  addHere(): void {
    const { scene, overlay, view } = this.page;
    const live = overlay.live?.seen ? overlay.live : null;
    const [x, y] = live ? live.hand : view.eye.pose.target;
    if (scene) this.addEnd(scene.on(x, y));
  }

  private announce(): void {
    if (this.measured) this.page.say(t("measured", { mm: (1000 * this.measured.straightM).toFixed(2) }));
    else if (this.ends.length) this.page.say(t("rulerBegun"));
  }

  private nudge(end: number, right: number, away: number): void {
    const { scene } = this.page;
    const at = plus(this.ends[end], [right, away, 0]);
    if (scene) this.setEnd(end, scene.on(at[0], at[1]));
  }

  /** Measure again after an end moved or the surface changed. */
  private measureAgain(): void {
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
    this.onChange();
  }

  private middle(): Vec | null {
    const [from, to] = this.ends;
    if (!to || !this.page.scene) return null;
    return this.page.scene.on((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  }
}
