/** Refinement where the camera rests: finer heights and picture of a large surface, fine textures. */
import { bulk } from "../server/connection";
import type { Page } from "../page";
import type { Scene } from "./scene";
import { fetchPart, type Window } from "./loading";
import { finePatch, hasTexture } from "./fine_texture";
import { includes, windowOf, type Box } from "./detail_window";

const LARGEST_TEXTURE_M = 0.03;
const TEXTURE_PIXELS = 512;
const MAX_PICTURE = 1_500_000;
const SAMPLES = [0, 0.5, 1];

export class Refiner {
  private window: Window | null = null;
  private texture: Box | null = null;
  private picture: Promise<Blob> | null = null;
  private scene: Scene | null = null;
  private ending = new AbortController();

  constructor(private page: Pick<Page, "hub" | "net" | "view" | "canvas" | "scene">) {
    page.view.rested = () => this.refine();
  }

  private refine(): void {
    const { scene, view } = this.page;
    if (scene !== this.scene) this.reset(scene);
    const visibleBox = scene && this.seen(scene);
    if (!scene || !visibleBox || !view.terrain) return;
    const fail = (error: Error): void => {
      if (error.name !== "AbortError") console.warn(error.message); // the coarser surface stays
    };
    void this.heights(scene, visibleBox).catch(fail);
    void this.textures(scene, visibleBox).catch(fail);
  }

  private reset(scene: Scene | null): void {
    this.ending.abort();
    this.scene = scene;
    this.window = this.texture = this.picture = null;
  }

  private async heights(scene: Scene, seen: Box): Promise<void> {
    const window = windowOf(scene.meta, seen, this.page.view.pixel_m());
    if (window && this.window && includes(this.window, window)) return;
    this.ending.abort();
    this.ending = new AbortController();
    if (!window) return this.setWindow(scene, null);
    const { signal } = this.ending;
    const [part, picture] = await Promise.all([fetchPart(scene.meta, window, signal), this.cropPicture(scene, window)]);
    if (signal.aborted || this.page.scene !== scene) return;
    this.setWindow(scene, window);
    scene.detail = part;
    this.page.view.terrain?.refine(part, picture?.bitmap ?? null, picture?.place);
    this.page.view.dirty = true;
    this.page.hub.tell("finer", scene);
  }

  private setWindow(scene: Scene, window: Window | null): void {
    const had = this.window !== null;
    this.window = window;
    if (window || !had) return;
    scene.detail = null;
    this.page.view.terrain?.refine(null);
    this.page.view.dirty = true;
  }

  /** Return the finer picture of a window, and its place. */
  private async cropPicture(scene: Scene, window: Window) {
    const { extent_m, fine_photo, levels, digest } = scene.meta;
    if (!fine_photo) return null;
    const blob = await (this.picture ??= bulk(`/scene/${digest}/photo-fine.jpg`).then((answer) => answer.blob()));
    const { rows, columns } = levels[window.level];
    const across = fine_photo[0] / columns;
    const along = fine_photo[1] / rows;
    const [x, y] = [Math.floor(window.column * across), Math.floor(window.row * along)];
    const right = Math.min(fine_photo[0], Math.ceil((window.column + window.columns) * across));
    const near = Math.min(fine_photo[1], Math.ceil((window.row + window.rows) * along));
    const [wide, long] = [Math.max(1, right - x), Math.max(1, near - y)];
    const share = Math.min(1, Math.sqrt(MAX_PICTURE / (wide * long)));
    const bitmap = await createImageBitmap(blob, x, y, wide, long, {
      resizeWidth: Math.max(1, Math.round(share * wide)),
      resizeHeight: Math.max(1, Math.round(share * long)),
      resizeQuality: "medium",
    });
    const [dx, dy] = [extent_m[0] / fine_photo[0], extent_m[1] / fine_photo[1]];
    const place: [number, number, number, number] = [x * dx - extent_m[0] / 2, extent_m[1] / 2 - y * dy, wide * dx, long * dy];
    return { bitmap, place };
  }

  private async textures(scene: Scene, seen: Box): Promise<void> {
    const [wide, long] = [seen.right - seen.left, seen.far - seen.near];
    const side = 1.15 * Math.max(wide, long);
    const had = this.texture;
    if (side > LARGEST_TEXTURE_M || !hasTexture(scene)) {
      this.texture = null;
      if (!had) return;
      this.page.view.terrain?.refineTexture(null);
      this.page.view.dirty = true;
      return;
    }
    if (had && contains(had, seen) && had.right - had.left < 2 * side) return;
    this.texture = { left: seen.left, right: seen.left + side, near: seen.near, far: seen.near + side };
    const centre: [number, number] = [(seen.left + seen.right) / 2, (seen.near + seen.far) / 2];
    const [x, y] = centre;
    this.texture = { left: x - side / 2, right: x + side / 2, near: y - side / 2, far: y + side / 2 };
    const patch = await finePatch(this.page.net, scene, centre, side, TEXTURE_PIXELS);
    if (this.page.scene !== scene) return;
    this.page.view.terrain?.refineTexture(patch);
    this.page.view.dirty = true;
  }

  /** Return the visible part of the surface; null if none is. */
  private seen(scene: Scene): Box | null {
    const { canvas, view } = this.page;
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const [w, l] = scene.meta.extent_m;
    const box: Box = { left: Infinity, near: Infinity, right: -Infinity, far: -Infinity };
    for (const x of SAMPLES)
      for (const y of SAMPLES) {
        const [o, d] = view.ray(left + x * width, top + y * height);
        const t = d[2] < 0 ? (view.eye.pose.target[2] - o[2]) / d[2] : Infinity;
        const reach = Math.min(t, view.camera.far);
        const [u, v] = [clamp(o[0] + reach * d[0], w), clamp(o[1] + reach * d[1], l)];
        box.left = Math.min(box.left, u);
        box.right = Math.max(box.right, u);
        box.near = Math.min(box.near, v);
        box.far = Math.max(box.far, v);
      }
    return box.left < box.right && box.near < box.far ? box : null;
  }
}

const clamp = (value: number, side: number): number => Math.min(Math.max(value, -side / 2), side / 2);

function contains(one: Box, other: Box): boolean {
  return one.left <= other.left && one.right >= other.right && one.near <= other.near && one.far >= other.far;
}
