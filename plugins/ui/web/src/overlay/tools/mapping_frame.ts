/** What the device reaches, as a frame on the picture that can be moved, sized and turned; and the region that is felt. */
import type { Page } from "../../page";
import type { Vec } from "../../server/protocol";
import { on } from "../../shortcuts";
import { t } from "../words";
import { COLOURS } from "../colours";
import { Draped } from "./draped_line";
import { COARSE, Handle, STEP_M } from "./handle";
import type { Picked } from "../picking";
import { AS_IT_LIES, corners, type Mapping, moved, type Reach, reach, whole, zoomed } from "./placement";

/** A device whose frame is wider than so many pictures, such as the mouse, has no edge to show. */
const MOST_PICTURES = 4;
const TURN_DEG = 1;
const LARGER = 1.02;
/** How far the handle for turning stands off the frame, of its length. */
const TURN_OFF = 0.12;
const LEAST_REGION_M = 0.0005;
const HALF = 0.5;

interface Reached {
  device: string;
  workspace_m: Vec | null;
}

export class MappingFrame implements Picked {
  shown = false;
  /** Called when anything of it changed. */
  changed: () => void = () => {};
  device = "";
  private workspace: Vec | null = null;
  /** While it is dragged or written: what the document will say. */
  private draft: Mapping | null = null;
  private writing = false;
  private line: Draped;
  private drawn: Draped;
  private from: Vec | null = null;

  constructor(private page: Page) {
    const { view, hub } = page;
    this.line = new Draped(view, 4, COLOURS.frame);
    this.drawn = new Draped(view, 4, COLOURS.device, true);
    const done = (): void => void (this.draft && this.write());
    const keep = { done, drag: () => {}, nudge: () => {} };
    new Handle(page, "move", t("frameMove"), {
      ...keep, at: () => this.corner(0, 0), drag: (to) => this.move(to[0], to[1]), nudge: (right, away) => this.step(right * STEP_M, away * STEP_M),
    }).element.dataset.sign = "✥";
    for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
      new Handle(page, "square", t("frameSize"), {
        ...keep, at: () => this.corner(u, v), drag: (to) => this.stretch(to), nudge: (right, away) => this.grow(LARGER ** (Math.abs(right) > Math.abs(away) ? right : away)),
      });
    }
    new Handle(page, "turn", t("frameTurn"), {
      ...keep, at: () => this.corner(0, 1 + 2 * TURN_OFF), drag: (to) => this.aim(to), nudge: (right, away) => this.rotate(TURN_DEG * (away || -right)),
    }).element.dataset.sign = "↻";
    hub.on("document", () => void this.ask());
    hub.on("shown", () => this.draw());
    on("enlarge", () => this.zoomHere());
    on("whole picture", () => this.whole());
  }

  /** As the document has it, or as it is being dragged. */
  get mapping(): Mapping {
    const said = this.page.document?.values?.mapping as Partial<Mapping> | null | undefined;
    return this.draft ?? { ...AS_IT_LIES, ...said };
  }

  /** Whether the device has an edge that can be seen. */
  get bounded(): boolean {
    const { scene } = this.page;
    const found = this.workspace && reach(this.mapping, this.workspace);
    return scene !== null && found !== null && found.size[0] < MOST_PICTURES * scene.meta.extent_m[0];
  }

  /** What the device reaches, or, where it reaches everything, the region that is felt. */
  get reach(): Reach | null {
    const { scene } = this.page;
    if (!scene) return null;
    const { extent_m } = scene.meta;
    if (this.bounded && this.workspace) return reach(this.mapping, this.workspace);
    const [x, y, width, length] = this.mapping.region_m ?? [0, 0, ...extent_m];
    return { centre: [x, y], size: [width, length], turnDeg: 0 };
  }

  show(on: boolean): void {
    this.shown = on;
    this.draw();
  }

  /** A rectangle is drawn with the mouse: only that is felt, enlarged. */
  get picking(): boolean {
    return this.page.overlay.picking.busy === this;
  }

  toggleRegion(): void {
    this.page.overlay.picking.take(this.picking ? null : this);
    this.changed();
  }

  begin(at: Vec): void {
    this.from = at;
  }

  drag(at: Vec): void {
    const { scene, overlay } = this.page;
    if (!this.from || !scene) return;
    const [a, b] = [this.from, at];
    this.drawn.put(scene, [[a[0], a[1]], [b[0], a[1]], [b[0], b[1]], [a[0], b[1]], [a[0], a[1]]]);
    this.drawn.visible = overlay.changed = true;
  }

  end(at: Vec): void {
    const from = this.from;
    this.page.overlay.picking.take(null);
    if (!from) return;
    const [width, length] = [Math.abs(at[0] - from[0]), Math.abs(at[1] - from[1])];
    if (Math.min(width, length) >= LEAST_REGION_M) this.zoom((from[0] + at[0]) / 2, (from[1] + at[1]) / 2, width, length);
  }

  left(): void {
    this.from = null;
    this.drawn.visible = false;
    this.page.overlay.changed = true;
    this.changed();
  }

  /** Half of what is felt now, about the hand. */
  zoomHere(): void {
    const { overlay, view, scene } = this.page;
    const now = this.reach;
    if (!scene || !now) return;
    const live = overlay.live?.seen ? overlay.live : null;
    const [x, y] = live ? live.hand : view.eye.pose.target;
    const size = now.size.map((side, axis) => Math.max(LEAST_REGION_M, HALF * Math.min(side, scene.meta.extent_m[axis])));
    this.zoom(x, y, size[0], size[1]);
  }

  /** Feel this part alone, and look at it. */
  zoom(x: number, y: number, width: number, length: number): void {
    const { scene, view } = this.page;
    if (!scene) return;
    view.focus(scene.on(x, y), Math.max(width, length));
    this.draft = zoomed(this.mapping, x, y, width, length);
    void this.write();
  }

  whole(): void {
    const { scene, view } = this.page;
    if (scene) view.frame(...scene.meta.extent_m);
    this.draft = whole(this.mapping);
    void this.write();
  }

  private step(right: number, away: number): void {
    const now = this.reach;
    if (now) this.move(now.centre[0] + right, now.centre[1] + away);
  }

  private move(x: number, y: number): void {
    this.change([x, y], 1, null);
  }

  private grow(factor: number): void {
    const now = this.reach;
    if (now) this.change(now.centre, factor, null);
  }

  /** A corner is where the pointer is; the frame keeps its shape and its middle. */
  private stretch(to: Vec): void {
    const now = this.reach;
    if (!now) return;
    const far = Math.hypot(to[0] - now.centre[0], to[1] - now.centre[1]);
    this.change(now.centre, Math.max(far / (Math.hypot(...now.size) / 2), 1 / COARSE), null);
  }

  private rotate(degrees: number): void {
    const now = this.reach;
    if (now) this.change(now.centre, 1, now.turnDeg + degrees);
  }

  /** The far side of the frame looks at the pointer; near quarter turns it is one. */
  private aim(to: Vec): void {
    const now = this.reach;
    if (!now) return;
    const degrees = (Math.atan2(to[1] - now.centre[1], to[0] - now.centre[0]) * 180) / Math.PI - 90;
    const quarter = 90 * Math.round(degrees / 90);
    this.change(now.centre, 1, Math.abs(degrees - quarter) < 2 ? quarter : degrees);
  }

  private change(centre: [number, number], larger: number, turnDeg: number | null): void {
    const now = this.reach;
    if (!now) return;
    if (this.bounded && this.workspace) this.draft = moved(this.mapping, this.workspace, centre, larger, turnDeg ?? now.turnDeg);
    else this.draft = zoomed(this.mapping, ...centre, now.size[0] * larger, now.size[1] * larger);
    this.draw();
  }

  /** Into the document, where what is felt follows; one write after the other, and of several the last. */
  private async write(): Promise<void> {
    this.draw();
    if (this.writing) return;
    this.writing = true;
    for (let written: Mapping | null = null; this.draft && written !== this.draft; ) {
      written = this.draft;
      try {
        await this.page.net.ask("set", { ...changes(written), apply: true });
      } catch (error) {
        this.page.say((error as Error).message);
        break;
      }
    }
    this.writing = false;
    this.draft = null;
    this.draw();
  }

  /** What the document's device reaches. */
  private async ask(): Promise<void> {
    try {
      const { device, workspace_m } = await this.page.net.ask<Reached>("reach");
      [this.device, this.workspace] = [device, workspace_m];
    } catch {
      [this.device, this.workspace] = ["", null];
    }
    this.draw();
  }

  private draw(): void {
    const { scene, overlay } = this.page;
    const now = this.shown ? this.reach : null;
    this.line.visible = now !== null;
    if (scene && now) {
      const around = corners(now);
      this.line.put(scene, [...around, around[0]]);
    }
    overlay.changed = true;
    this.changed();
  }

  /** A place of the frame, its sides at 1 and -1, on the surface; null while it is not shown. */
  private corner(u: number, v: number): Vec | null {
    const { scene } = this.page;
    const now = this.shown ? this.reach : null;
    if (!scene || !now) return null;
    const [left, right, , far] = corners(now);
    const middle = now.centre;
    const at = (axis: 0 | 1): number =>
      middle[axis] + (u * (right[axis] - left[axis])) / 2 + (v * (far[axis] - left[axis])) / 2;
    const [x, y] = [at(0), at(1)];
    const edge = scene.on(middle[0] + (far[0] - left[0]) / 2, middle[1] + (far[1] - left[1]) / 2);
    return [x, y, v > 1 ? Math.max(edge[2], scene.on(x, y)[2]) : scene.on(x, y)[2]];
  }
}

/** What the document has to say of a mapping: nothing of what is as by default. */
function changes(mapping: Mapping): { changes: Record<string, unknown>; removed: string[] } {
  const keys = ["scale", "region_m", "rotation_deg", "offset_m"] as const;
  const usual = (key: (typeof keys)[number]): boolean => String(mapping[key]) === String(AS_IT_LIES[key]);
  const said = keys.filter((key) => !usual(key)).map((key) => [`mapping.${key}`, mapping[key]]);
  return { changes: Object.fromEntries(said), removed: keys.filter(usual).map((key) => `mapping.${key}`) };
}
