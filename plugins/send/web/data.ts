/** What a sent page holds: the picture as Python packed it (tangible_send/packing.py), as a surface to draw and to touch. */
import { decode } from "kit/base64";
import type { Meta } from "kit/server/messages";
import { Scene, type Labels } from "kit/surface/scene";
import { BORDER, Spline } from "./touch/spline";
import type { Row } from "./touch/law";

/** A text by language. */
export type ByLanguage<T> = Record<string, T>;

export interface Description {
  overview: string;
  heading: string;
  parts: [label: string, says: string][];
  left_out: string;
}

export interface Packed {
  meta: Meta;
  /** Coefficients of the spline: low + step * a number of 16 bits, metres. */
  low_m: number;
  step_m: number;
  /** Base64 of deflated bytes: see `unfold`. */
  heights: string;
  labels: string;
  /** Index into `meta.materials` for each label. */
  kinds: number[];
  /** Stiffness, damping and frictions: of each label, or one for all. */
  rows: Row[];
  /** Base64 of a JPEG; empty without a picture. */
  photo: string;
  describes: ByLanguage<Description>;
  says: ByLanguage<string>;
}

export interface Sent {
  scene: Scene;
  spline: Spline;
  row: (x: number, y: number) => Row;
}

/** Return the data of this page. */
export function readData(): Packed {
  return JSON.parse(document.getElementById("data")!.textContent!) as Packed;
}

export async function unpack(data: Packed): Promise<Sent> {
  const { meta, low_m, step_m } = data;
  const [rows, columns] = [meta.rows + 2 * BORDER, meta.columns + 2 * BORDER];
  const [heights, labels, photo] = await Promise.all([
    inflate(data.heights).then((bytes) => unfold(bytes, rows, columns)),
    data.labels ? inflate(data.labels).then((bytes) => unfold(bytes, meta.rows, meta.columns)) : null,
    data.photo ? createImageBitmap(new Blob([decode(data.photo)], { type: "image/jpeg" })) : null,
  ]);
  const coefficients = new Float32Array(heights.length);
  for (let k = 0; k < heights.length; k++) coefficients[k] = low_m + step_m * heights[k]!;
  const spline = new Spline(coefficients, rows, columns, ...meta.extent_m);
  const grid = spline.centres();
  const scene = new Scene(meta, { grid, labels: labels as Labels | null }, Uint16Array.from(data.kinds), photo);
  const only = data.rows.length === 1 ? data.rows[0]! : null;
  return { scene, spline, row: (x, y) => only ?? data.rows[labels![grid.cell(x, y)]!]! };
}

async function inflate(base64: string): Promise<Uint8Array> {
  const bytes = new Blob([decode(base64)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(bytes).arrayBuffer());
}

/** Return numbers of 16 bits from their differences to the one above: all low bytes, then all high ones. */
function unfold(bytes: Uint8Array, rows: number, columns: number): Uint16Array {
  const count = rows * columns;
  const numbers = new Uint16Array(count);
  for (let k = 0; k < count; k++) {
    const zigzag = bytes[k]! | (bytes[count + k]! << 8);
    const above = k >= columns ? numbers[k - columns]! : 0;
    const left = k % columns ? numbers[k - 1]! : 0;
    const corner = k >= columns && k % columns ? numbers[k - columns - 1]! : 0;
    numbers[k] = left + above - corner + ((zigzag >> 1) ^ -(zigzag & 1));
  }
  return numbers;
}
