/** The surface of an interval as the program sends it: heights and labels without any name (tangible_study/desks). */
import { decode } from "kit/base64";
import type { Server } from "kit/page";
import type { Meta } from "kit/server/messages";
import { Grid } from "kit/surface/grid";
import { Scene } from "kit/surface/scene";

interface Packed {
  meta: Meta;
  /** Base64 of float32 heights, and of a label of 16 bits for each cell; empty without labels. */
  heights: string;
  labels: string;
  /** Index into `meta.materials` for each label. */
  kinds: number[];
}

/** Fetch a surface by its number; null if its interval is over. */
export async function fetchSurface(net: Pick<Server, "ask">, number: number): Promise<Scene | null> {
  const packed = await net.ask<Packed | null>("surface", { which: number });
  if (!packed) return null;
  const { meta, heights, labels, kinds } = packed;
  const { rows, columns, extent_m: [w, l] } = meta;
  const place = { left: -w / 2, far: l / 2, dx: w / columns, dy: l / rows };
  const grid = new Grid(new Float32Array(decode(heights).buffer), rows, columns, place);
  return new Scene(meta, { grid, labels: labels ? new Uint16Array(decode(labels).buffer) : null }, Uint16Array.from(kinds), null);
}
