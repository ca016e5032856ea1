/** What the server keeps of a surface, as the page has it. */
import { Grid } from "./grid";
import type { LayerMeta, Meta } from "../server/messages";
import { bulk } from "../server/connection";
import { Scene, type Part } from "./scene";

/** Cells of a level: from a row and a column on, so many. */
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

/** When it has been drawn for the first time. */
const PREPARED_MS = 400;

const layers = new WeakMap<Scene, Map<string, Promise<Layer>>>();

/** The coarsest level, which can be drawn at once. */
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

/** Values to be warped over the surface: fetched when they are first asked for. */
export function fetchLayer(scene: Scene, name: string): Promise<Layer> {
  if (!layers.has(scene)) layers.set(scene, new Map());
  const known = layers.get(scene)!;
  const found =
    known.get(name) ??
    bulk(`${root(scene.meta)}/${name}.f32`).then(async (answer) => ({
      ...scene.meta.layers[name],
      values: new Float32Array(await answer.arrayBuffer()),
    }));
  known.set(name, found);
  found.catch(() => known.delete(name));
  return found;
}

function root(meta: Meta): string {
  return `/scene/${meta.digest}`;
}

/** Heights and labels of a window. */
export async function fetchPart(meta: Meta, window: Window, signal?: AbortSignal): Promise<Part> {
  const { level, row, rows, column, columns } = window;
  const asked = (bytes: number) => ({ row, rows, column, columns, bytes, of: meta.levels[level].columns });
  const [heights, labels] = await Promise.all([
    bulk(`${root(meta)}/height-${level}.f32`, asked(4), signal).then((answer) => answer.arrayBuffer()),
    meta.labels
      ? bulk(`${root(meta)}/labels-${level}.u`, asked(meta.label_bytes), signal).then((answer) => answer.arrayBuffer())
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
