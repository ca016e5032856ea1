/** The device's reach as a frame on the picture that can be moved, sized and turned; and the enlarged region. */
import type { Page, PointerTool } from "../../page";
import type { Vec } from "../../server/protocol";
import { on } from "../../shortcuts";
import { decimal } from "../../words/words";
import { t } from "../words";
import { COLOURS } from "../colours";
import { DrapedLine } from "./draped_line";
import { COARSE, Handle, STEP_M } from "./handle";
import { IDENTITY, corners, type Mapping, movePlacement, type Reach, reachOf, wholePicture, zoomTo } from "./placement";

/** Width in pictures from which a device's frame is not shown, as for the mouse. */
const MAX_PICTURES = 4;
const TURN_DEG = 1;
const LARGER = 1.02;
/** Distance of the turning handle from the frame, as a share of its length. */
const TURN_OFF = 0.12;
const MIN_REGION_M = 0.0005;
const HALF = 0.5;

interface Reached {
  device: string;
  workspace_m: Vec | null;
}

export class MappingFrame implements PointerTool {
  shown = false;
  /** Called when the frame changed. */
  onChange: () => void = () => {};
  device = "";
  private workspace: Vec | null = null;
  /** The mapping while it is dragged or written. */
  private draft: Mapping | null = null;
  private writing = false;
  /** Number of requests of the reach so far; only the answer to the last one counts. */
  private round = 0;
  private line: DrapedLine;
  private drawn: DrapedLine;
  private from: Vec | null = null;

  constructor(private page: Pick<Page, "hub" | "net" | "view" | "overlay" | "scene" | "document" | "say">) {
    const { view, hub } = page;
    this.line = new DrapedLine(view, 4, COLOURS.frame);
    this.drawn = new DrapedLine(view, 4, COLOURS.device, true);
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

  /** The document's mapping, or the one being dragged. */
  get mapping(): Mapping {
    const said = this.page.document?.values?.mapping as Partial<Mapping> | null | undefined;
    return this.draft ?? { ...IDENTITY, ...said };
  }

  /** True if the device's reach has a visible edge. */
  get isBounded(): boolean {
    const { scene } = this.page;
    const area = this.workspace && reachOf(this.mapping, this.workspace);
    return scene !== null && area !== null && area.size[0] < MAX_PICTURES * scene.meta.extent_m[0];
  }

  /** The device's reach, or the enlarged region if the device reaches everything. */
  get reach(): Reach | null {
    const { scene } = this.page;
    if (!scene) return null;
    const { extent_m } = scene.meta;
    if (this.isBounded && this.workspace) return reachOf(this.mapping, this.workspace);
    const [x, y, width, length] = this.mapping.region_m ?? [0, 0, ...extent_m];
    return { centre: [x, y], size: [width, length], turnDeg: 0 };
  }

  show(on: boolean): void {
    this.shown = on;
    this.draw();
  }

  /** True while a region is drawn with the mouse. */
  get picking(): boolean {
    return this.page.overlay.picking.busy === this;
  }

  toggleRegion(): void {
    this.page.overlay.picking.take(this.picking ? null : this);
    this.onChange();
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
    if (Math.min(width, length) >= MIN_REGION_M) this.zoom((from[0] + at[0]) / 2, (from[1] + at[1]) / 2, width, length);
  }

  left(): void {
    this.from = null;
    this.drawn.visible = false;
    this.page.overlay.changed = true;
    this.onChange();
  }

  /** Enlarge the half of the region around the hand. */
  zoomHere(): void {
    const { overlay, view, scene } = this.page;
    const now = this.reach;
    if (!scene || !now) return;
    const live = overlay.live?.seen ? overlay.live : null;
    const [x, y] = live ? live.hand : view.eye.pose.target;
    const size = now.size.map((side, axis) => Math.max(MIN_REGION_M, HALF * Math.min(side, scene.meta.extent_m[axis])));
    this.zoom(x, y, size[0], size[1]);
  }

  /** Enlarge a region and show it. */
  zoom(x: number, y: number, width: number, length: number): void {
    const { scene, view } = this.page;
    if (!scene) return;
    view.focus(scene.on(x, y), Math.max(width, length));
    this.draft = zoomTo(this.mapping, x, y, width, length);
    const [w, l] = [width, length].map((side) => decimal(1000 * side, 1));
    void this.write(t("enlarged", { width: w!, length: l! }));
  }

  whole(): void {
    const { scene, view } = this.page;
    if (scene) view.frame(...scene.meta.extent_m);
    this.draft = wholePicture(this.mapping);
    void this.write(t("wholeFelt"));
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

  /** Move a corner to the pointer; the frame keeps its shape and its middle. */
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

  /** Turn the frame's far side towards the pointer, snapping to quarter turns. */
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
    if (this.isBounded && this.workspace) this.draft = movePlacement(this.mapping, this.workspace, centre, larger, turnDeg ?? now.turnDeg);
    else this.draft = zoomTo(this.mapping, ...centre, now.size[0] * larger, now.size[1] * larger);
    this.draw();
  }

  /** Write the mapping into the document; writes follow one another, and only the newest waiting one is sent.
   * done: the confirmation once it is written. */
  private async write(done = ""): Promise<void> {
    this.draw();
    if (this.writing) return;
    this.writing = true;
    for (let written: Mapping | null = null; this.draft && written !== this.draft; ) {
      written = this.draft;
      try {
        await this.page.net.ask("set", { ...changes(written), apply: true });
        this.page.say(done, { topic: "mapping", asked: true });
      } catch (error) {
        this.page.say((error as Error).message);
        break;
      }
    }
    this.writing = false;
    this.draft = null;
    this.draw();
  }

  /** Request the reach of the document's device. */
  private async ask(): Promise<void> {
    const now = ++this.round;
    let found: Reached = { device: "", workspace_m: null };
    try {
      found = await this.page.net.ask<Reached>("reach");
    } catch {
      // the document has no device that can be loaded
    }
    if (now !== this.round) return; // another document was opened
    [this.device, this.workspace] = [found.device, found.workspace_m];
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
    this.onChange();
  }

  /** Return a place of the frame on the surface, its sides at 1 and -1; null while it is hidden. */
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

/** Return the edit that sets a mapping; default values are removed. */
function changes(mapping: Mapping): { changes: Record<string, unknown>; removed: string[] } {
  const keys = ["scale", "region_m", "rotation_deg", "offset_m"] as const;
  const usual = (key: (typeof keys)[number]): boolean => String(mapping[key]) === String(IDENTITY[key]);
  const said = keys.filter((key) => !usual(key)).map((key) => [`mapping.${key}`, mapping[key]]);
  return { changes: Object.fromEntries(said), removed: keys.filter(usual).map((key) => `mapping.${key}`) };
}
