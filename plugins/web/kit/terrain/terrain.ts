/** The drawn surface: the whole, and a finer part where the camera looks. */
import { Group, Vector2, Vector3, Vector4, type Texture } from "three";
import { Grid } from "../surface/grid";
import type { Meta } from "../server/messages";
import type { Part, Scene } from "../surface/scene";
import type { Layer } from "../surface/loading";
import { Needles } from "./needles";
import { Sheet, type Uniforms } from "./sheet";
import { LOOKS, STEEPS } from "./shader";
import { heatTexture, kindsTexture, numbers } from "./textures";

const MAX_MOVING_NEEDLES = 4;
const NOTHING = new Float32Array(1);

/** Options of drawing a surface. */
export interface Looks {
  look: string;
  /** Opacity of a layer over the picture. */
  cover: number;
  /** Style of steep walls at depth edges. */
  steep: keyof typeof STEEPS;
  /** Angle from which a wall counts as steep. */
  steepDeg: number;
  azimuthDeg: number;
  elevationDeg: number;
  /** Share of the raking light. */
  raking: number;
  normals: number;
}

/** Heights of a square of fine texture. */
export interface FinePatch {
  x_m: number;
  y_m: number;
  side_m: number;
  pixels: number;
  heights: Float32Array;
}

/** A surface as it is drawn. */
export type Drawable = Pick<Scene, "whole" | "kinds" | "photo"> & { meta: Pick<Meta, "extent_m" | "labels" | "height_m"> };

/** Return a flat surface, to compile the shaders that any other uses. */
export function flatSurface(): Drawable {
  const grid = new Grid(new Float32Array(4), 2, 2, { left: -0.5, far: 0.5, dx: 0.5, dy: 0.5 });
  const meta: Drawable["meta"] = { extent_m: [1, 1], labels: 0, height_m: [0, 0] };
  return { meta, whole: { grid, labels: null }, kinds: new Uint16Array(1), photo: null };
}

export class Terrain {
  readonly group = new Group();
  private common: Uniforms;
  private whole: Sheet;
  private detail: Sheet | null = null;
  private needles: Needles;
  private looks: Looks;

  constructor(
    private scene: Drawable,
    looks: Looks,
    private coarse = false,
  ) {
    const [w, l] = scene.meta.extent_m;
    this.common = {
      extent: { value: new Vector4(w, l, 0, 0) },
      kinds: { value: kindsTexture(scene.kinds) },
      values: { value: numbers(NOTHING, 1, 1) },
      fine: { value: numbers(NOTHING, 1, 1) },
      finePlace: { value: new Vector4() },
      heat: { value: heatTexture() },
      span: { value: new Vector2() },
      key: { value: new Vector3(0, 0, 1) },
      labelled: { value: scene.meta.labels > 0 },
      pictured: { value: scene.photo !== null },
      period: { value: w / 60 },
      ...Object.fromEntries(["raking", "steep", "cut", "look", "cover"].map((name) => [name, { value: 0 }])),
    };
    this.whole = new Sheet(scene.whole, this.common, scene.photo, [-w / 2, l / 2, w, l], coarse);
    this.needles = new Needles(this.whole);
    this.group.add(this.whole.mesh, this.needles.lines);
    this.looks = looks;
    this.show(looks);
  }

  /** Set the options; `layer` for a look of values. */
  show(looks: Looks, layer: Layer | null = null): void {
    this.looks = looks;
    const kind = LOOKS[looks.look as keyof typeof LOOKS] ?? (layer ? LOOKS.values : LOOKS.relief);
    this.set("look", kind);
    this.set("cover", looks.cover);
    this.set("cut", STEEPS[looks.steep]);
    this.set("steep", Math.tan((looks.steepDeg * Math.PI) / 180));
    this.set("raking", looks.raking);
    const [a, e] = [looks.azimuthDeg, looks.elevationDeg].map((deg) => (deg * Math.PI) / 180);
    (this.common.key.value as Vector3).set(Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e));
    (this.common.span.value as Vector2).set(...(layer ? ([layer.low, layer.high] as const) : this.scene.meta.height_m));
    if (layer) this.replace("values", numbers(layer.values, layer.columns, layer.rows));
    this.needles.density = looks.normals;
  }

  /** Draw a finer part with its picture; none with null. */
  refine(part: Part | null, picture: ImageBitmap | null = null, pictured?: [number, number, number, number]): void {
    if (this.detail) this.drop(this.detail);
    this.detail = null;
    this.whole.cut(0, 0, 0, 0);
    if (part) this.addDetail(part, picture, pictured);
    this.needles.dispose();
    this.group.remove(this.needles.lines);
    this.needles = new Needles(this.detail ?? this.whole);
    this.needles.density = this.looks.normals;
    this.group.add(this.needles.lines);
  }

  /** Set the fine texture of a square, shown as slopes in the light. */
  refineTexture(patch: FinePatch | null): void {
    const place = this.common.finePlace.value as Vector4;
    if (!patch) place.set(0, 0, 0, 0);
    else {
      place.set(patch.x_m, patch.y_m, patch.side_m, 0);
      this.replace("fine", numbers(patch.heights, patch.pixels, patch.pixels));
    }
  }

  /** Draw fewer triangles while the camera moves, if all take long. */
  set moving(moving: boolean) {
    this.coarse = moving;
    for (const sheet of [this.whole, this.detail]) if (sheet) sheet.moving = moving;
    this.needles.density = moving ? Math.min(this.looks.normals, MAX_MOVING_NEEDLES) : this.looks.normals;
  }

  get moving(): boolean {
    return this.coarse;
  }

  /** Set the period of patterns, metres. */
  set period(metres: number) {
    this.set("period", metres);
  }

  dispose(): void {
    for (const name of ["kinds", "values", "fine", "heat"]) (this.common[name].value as Texture).dispose();
    this.needles.dispose();
    this.whole.dispose();
    this.detail?.dispose();
  }

  private addDetail(part: Part, picture: ImageBitmap | null, pictured?: [number, number, number, number]): void {
    const [w, l] = this.scene.meta.extent_m;
    this.detail = new Sheet(part, this.common, picture ?? this.scene.photo, pictured ?? [-w / 2, l / 2, w, l]);
    this.group.add(this.detail.mesh);
    const { rows, columns, place } = part.grid;
    const { dx, dy } = this.scene.whole.grid.place; // the sheets overlap by a cell, so that there is no gap
    const [right, near] = [place.left + columns * place.dx, place.far - rows * place.dy];
    const inner = (value: number, rim: number, by: number): number => (Math.abs(value) < rim ? value + by : 2 * value);
    const [left, far] = [inner(place.left, 0.4999 * w, dx), inner(place.far, 0.4999 * l, -dy)];
    this.whole.cut(left, inner(near, 0.4999 * l, dy), inner(right, 0.4999 * w, -dx), far);
  }

  private drop(sheet: Sheet): void {
    this.group.remove(sheet.mesh);
    sheet.dispose();
  }

  private replace(name: string, texture: Texture): void {
    (this.common[name].value as Texture).dispose();
    this.set(name, texture);
  }

  private set(name: string, value: unknown): void {
    this.common[name].value = value;
  }
}
