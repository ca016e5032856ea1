/** Loading of a surface's arrays from the server. */
import { Grid } from "./grid";
import type { LayerMeta, Meta } from "../server/messages";
import { bulk } from "../server/connection";
import { Scene, type Part } from "./scene";

/** A window of a level: first row and column, and their numbers. */
export interface Window {
  level: number;
  row: number;
  rows: number;
  column: number;
  columns: number;
}

export interface Layer extends LayerMeta {
  values: Float32Array;
}

/** Delay of building pyramids, ms: after the first drawing. */
const PREPARED_MS = 400;

const layers = new WeakMap<Scene, Map<string, Promise<Layer>>>();

/** Load the coarsest level, which is drawn first. */
export async function loadScene(meta: Meta): Promise<Scene> {
  const level = meta.levels.length - 1;
  const { rows, columns } = meta.levels[level];
  const [whole, kinds, photo] = await Promise.all([
    fetchPart(meta, { level, row: 0, rows, column: 0, columns }),
    bulk(`${root(meta)}/materials.u16`).then((answer) => answer.arrayBuffer()),
    meta.photo ? bulk(`${root(meta)}/photo.jpg`).then((answer) => answer.blob()).then((it) => createImageBitmap(it)) : null,
  ]);
  return new Scene(meta, whole, new Uint16Array(kinds), photo);
}

/** Load a layer of values, once. */
export function fetchLayer(scene: Scene, name: string): Promise<Layer> {
  if (!layers.has(scene)) layers.set(scene, new Map());
  const known = layers.get(scene)!;
  const layer =
    known.get(name) ??
    bulk(`${root(scene.meta)}/${name}.f32`).then(async (answer) => ({
      ...scene.meta.layers[name],
      values: new Float32Array(await answer.arrayBuffer()),
    }));
  known.set(name, layer);
  layer.catch(() => known.delete(name));
  return layer;
}

function root(meta: Meta): string {
  return `/scene/${meta.digest}`;
}

/** Load heights and labels of a window. */
export async function fetchPart(meta: Meta, window: Window, signal?: AbortSignal): Promise<Part> {
  const { level, row, rows, column, columns } = window;
  const windowQuery = (bytes: number) => ({ row, rows, column, columns, bytes, of: meta.levels[level].columns });
  const [heights, labels] = await Promise.all([
    bulk(`${root(meta)}/height-${level}.f32`, windowQuery(4), signal).then((answer) => answer.arrayBuffer()),
    meta.labels
      ? bulk(`${root(meta)}/labels-${level}.u`, windowQuery(meta.label_bytes), signal).then((answer) => answer.arrayBuffer())
      : null,
  ]);
  const [w, l] = meta.extent_m;
  const { step } = meta.levels[level];
  const [dx, dy] = [(step * w) / meta.columns, (step * l) / meta.rows];
  const place = { left: column * dx - w / 2, far: l / 2 - row * dy, dx, dy };
  const grid = new Grid(new Float32Array(heights), rows, columns, place);
  setTimeout(() => grid.prepare(), PREPARED_MS);
  return { grid, labels: labels && (meta.label_bytes === 2 ? new Uint16Array(labels) : new Uint32Array(labels)) };
}
