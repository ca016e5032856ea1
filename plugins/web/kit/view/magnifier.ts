/** A magnifier: the surface under the hand at the scale of a finger, with its fine texture. */
import "./magnifier.css";
import type { Page } from "../page";
import type { State } from "../server/protocol";
import { finePatch } from "../surface/fine_texture";
import type { Settings } from "./settings";
import type { FinePatch } from "../terrain/terrain";
import { materialWord } from "../words/material_words";
import { t } from "./words";

const PIXELS = 192;
/** Share of its width that the hand leaves its middle by before it follows. */
const FOLLOWS = 0.22;
const PAUSE_MS = 150;
const AWAY_M = 0.5;

export class Magnifier {
  private box = document.createElement("figure");
  private canvas = document.createElement("canvas");
  private cross = document.createElement("span");
  private caption = document.createElement("figcaption");
  private patch: FinePatch | null = null;
  private asking = false;
  private askedMs = 0;
  private lightSaid = "";

  constructor(
    private page: Pick<Page, "hub" | "net" | "canvas" | "scene">,
    private settings: Settings,
  ) {
    this.box.id = "lens";
    this.box.hidden = true;
    this.canvas.width = this.canvas.height = PIXELS;
    this.canvas.setAttribute("role", "img");
    this.cross.ariaHidden = "true";
    const glass = document.createElement("div");
    glass.append(this.canvas, this.cross);
    this.box.append(glass, this.caption);
    page.canvas.after(this.box);
    page.hub.on("state", (state) => this.follow(state));
    page.hub.on("shown", () => this.close());
    page.hub.on("finer", () => this.draw());
  }

  /** Take over changed width or light. */
  change(): void {
    if (!this.settings.lensMm) return this.close();
    const { azimuthDeg, elevationDeg } = this.settings;
    const text = `${azimuthDeg} ${elevationDeg}`;
    if (text !== this.lightSaid) this.draw();
    this.lightSaid = text;
    if (this.patch && this.patch.side_m !== this.settings.lensMm / 1000) void this.look([this.patch.x_m, this.patch.y_m]);
  }

  private close(): void {
    this.patch = null;
    this.box.hidden = true;
  }

  private follow(state: State): void {
    const { scene } = this.page;
    if (!this.settings.lensMm || !scene || state.hand[2] > AWAY_M) return;
    const [x, y] = scene.on(state.hand[0], state.hand[1]);
    const { patch } = this;
    const off = patch ? Math.max(Math.abs(x - patch.x_m), Math.abs(y - patch.y_m)) / patch.side_m : 1;
    if (patch) this.point(x, y, patch);
    if (off > FOLLOWS && performance.now() - this.askedMs > PAUSE_MS) void this.look([x, y]);
  }

  private async look(at: [number, number]): Promise<void> {
    const { scene, net } = this.page;
    if (this.asking || !scene) return;
    this.asking = true;
    this.askedMs = performance.now();
    try {
      const patch = await finePatch(net, scene, at, this.settings.lensMm / 1000, PIXELS);
      if (scene !== this.page.scene || !this.settings.lensMm) return;
      this.patch = patch;
      this.draw();
      this.point(...at, patch);
      this.describe(patch);
    } catch {
      this.close(); // the surface is gone, or the texture process is starting: the next move asks again
    } finally {
      this.asking = false;
    }
  }

  private point(x: number, y: number, { x_m, y_m, side_m }: FinePatch): void {
    const { style } = this.cross;
    style.left = `${(50 + (100 * (x - x_m)) / side_m).toFixed(1)}%`;
    style.top = `${(50 - (100 * (y - y_m)) / side_m).toFixed(1)}%`;
  }

  private describe(patch: FinePatch): void {
    const { scene } = this.page;
    const material = scene?.material(patch.x_m, patch.y_m);
    const side = (1000 * patch.side_m).toFixed(0);
    const [grain, depth] = material ? [(1000 * material.grain_m).toPrecision(2), (1e6 * material.roughness_m).toFixed(0)] : [];
    this.caption.textContent = material?.roughness_m
      ? t("lensTextured", { side, material: materialWord(material.name), grain: grain!, depth: depth! })
      : t("lensSmooth", { side, material: material ? materialWord(material.name) : t("noMaterial") });
    this.canvas.setAttribute("aria-label", this.caption.textContent);
    this.box.hidden = false;
  }

  private draw(): void {
    const { patch } = this;
    const { scene } = this.page;
    if (!patch || !scene) return;
    const { azimuthDeg, elevationDeg } = this.settings;
    const around = (x: number, y: number): number => scene.on(x, y)[2];
    this.canvas.getContext("2d")!.putImageData(shadePatch(patch, around, azimuthDeg, elevationDeg), 0, 0);
  }
}

/** Return a patch on its ground in raking light. */
export function shadePatch(
  { x_m, y_m, side_m, pixels, heights }: FinePatch, around: (x: number, y: number) => number, azimuthDeg: number, elevationDeg: number,
): ImageData {
  const pitch = side_m / pixels;
  const whole = new Float64Array(pixels * pixels);
  for (let j = 0, k = 0; j < pixels; j++)
    for (let i = 0; i < pixels; i++, k++) {
      whole[k] = heights[k] + around(x_m + (i + 0.5) * pitch - side_m / 2, y_m + side_m / 2 - (j + 0.5) * pitch);
    }
  const [a, e] = [azimuthDeg, elevationDeg].map((deg) => (deg * Math.PI) / 180);
  const key = [Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e)];
  const image = new ImageData(pixels, pixels);
  const last = pixels - 1;
  for (let j = 0, k = 0; j < pixels; j++)
    for (let i = 0; i < pixels; i++, k += 4) {
      const [left, right] = [Math.max(i - 1, 0), Math.min(i + 1, last)];
      const [up, down] = [Math.max(j - 1, 0), Math.min(j + 1, last)];
      const gx = (whole[j * pixels + right] - whole[j * pixels + left]) / (Math.max(right - left, 1) * pitch);
      const gy = (whole[up * pixels + i] - whole[down * pixels + i]) / (Math.max(down - up, 1) * pitch);
      const light = (key[2] - gx * key[0] - gy * key[1]) / Math.hypot(gx, gy, 1);
      const tone = 30 + 200 * Math.max(light, 0);
      image.data.set([tone, 0.96 * tone, 0.88 * tone, 255], k);
    }
  return image;
}
