/** What the editor asks the program for. */
import { bulk, type Net, token } from "../../../server/connection";
import type { Part } from "../drawing/drawing";
import type { Labels, Point } from "../pixels/labels";
import type { Proposed } from "../pixels/mask";

export type Heights = { by: "depth" | "given" | "guess"; round_m: number; bulge_m: number; detail_m: number };
export const KINDS = ["grabcut", "watershed"] as const;

interface Answer {
  columns: number;
  rows: number;
  picture: string;
  labels: string;
  digest: string;
  parts: { number: number; name: string; height_m: number | null; material: string | null; pixels: number; at: Point }[];
  heights: Heights;
  top_m: number;
  title: string;
  language: string;
}

export interface Opened extends Pick<Answer, "digest" | "heights" | "top_m" | "title" | "language"> {
  labels: Labels;
  picture: ImageBitmap;
  parts: Part[];
}

export interface Saved {
  path: string;
  digest: string;
  /** Of each label, the numbers that its pieces have now. */
  numbers: Record<string, number[]>;
}

export async function opened(net: Net): Promise<Opened> {
  const said = await net.ask<Answer>("parts_open");
  const [labels, picture] = await Promise.all([
    bulk(`/scene/${said.labels}`).then((each) => each.arrayBuffer()),
    bulk(`/scene/${said.picture}`).then(async (each) => createImageBitmap(await each.blob())),
  ]);
  const { columns, rows, digest, heights, top_m, title, language } = said;
  const parts = said.parts.map(({ number, name, height_m, material }) => {
    const automatic = height_m === null && heights.by !== "given";
    return { label: number, name, height_m: height_m ?? 0, material, automatic };
  });
  return { digest, heights, top_m, title, language, picture, parts, labels: { columns, rows, data: new Uint16Array(labels) } };
}

export const proposed = (net: Net, points: readonly Point[], width_px: number, kind: string): Promise<Proposed | null> =>
  net.ask("parts_propose", { points: whole(points), width_px: Math.max(1, Math.round(width_px)), kind, within: null });

export async function snapped(net: Net, points: readonly Point[], reach_px: number): Promise<Point[]> {
  const said = await net.ask<{ points: Point[] }>("parts_snap", { points: whole(points), reach_px: Math.max(1, Math.round(reach_px)) });
  return said.points;
}

/** Labels are sent as a file, then what is said of them. */
export async function save(net: Net, labels: Labels, parts: readonly Part[], told: Record<string, unknown>): Promise<Saved> {
  const upload = await net.ask<string>("batch");
  const gzip = new Blob([labels.data as Uint16Array<ArrayBuffer>]).stream().pipeThrough(new CompressionStream("gzip"));
  const response = await fetch(`/upload/${upload}/labels.gz?token=${encodeURIComponent(token)}`, {
    method: "PUT",
    body: await new Response(gzip).blob(),
  });
  if (!response.ok) throw new Error(await response.text());
  const said = parts.map(({ label, name, height_m, material, automatic }) => {
    return { label, name, height_m: automatic ? null : height_m, material };
  });
  return net.ask<Saved>("parts_save", { upload, parts: said, ...told });
}

const whole = (points: readonly Point[]): number[][] => points.map((each) => each.map((part) => Math.round(10 * part) / 10));
