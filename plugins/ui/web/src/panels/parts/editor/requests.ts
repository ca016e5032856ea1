/** Requests of the parts editor to the server. */
import type { Server } from "kit/page";
import { bulk } from "kit/server/connection";
import { token } from "kit/server/token";
import { language as ours } from "kit/words/words";
import type { HowToPropose } from "../controls/tools";
import type { Part } from "../drawing/drawing";
import type { Heights } from "../drawing/picture_details";
import type { Labels, Point } from "../pixels/labels";
import type { Proposal } from "../pixels/mask";

export const KINDS = ["regions", "grabcut", "watershed"] as const;

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
  /** False for a picture that nobody has divided yet. */
  divided: boolean;
  /** The pipeline file of the document; empty if it has none yet. */
  file: string;
  /** Folder of the photograph, in which a new file may be written; empty if it may not. */
  beside: string;
}

export interface Opened extends Pick<Answer, "digest" | "heights" | "top_m" | "title" | "language" | "divided" | "file" | "beside"> {
  labels: Labels;
  picture: ImageBitmap;
  parts: Part[];
}

export interface Saved {
  /** The pipeline file. */
  file: string;
  digest: string;
  /** The new numbers of each label's pieces. */
  numbers: Record<string, number[]>;
}

export async function openParts(net: Server): Promise<Opened> {
  const answer = await net.ask<Answer>("parts_open");
  const [labels, picture] = await Promise.all([
    bulk(`/scene/${answer.labels}`).then((each) => each.arrayBuffer()),
    bulk(`/scene/${answer.picture}`).then(async (each) => createImageBitmap(await each.blob())),
  ]);
  const { columns, rows, digest, heights, top_m, title, language, divided, file, beside } = answer;
  const parts = answer.parts.map(({ number, name, height_m, material }) => {
    const automatic = height_m === null && heights.by !== "given";
    return { label: number, name, height_m: height_m ?? 0, material, automatic };
  });
  const named = file || language !== "en" ? language : ours; // of a new file, names are in the language of the page
  return { digest, heights, top_m, title, language: named, divided, file, beside, picture, parts, labels: { columns, rows, data: new Uint16Array(labels) } };
}

/** The parts that the program proposes for a whole picture. */
export interface FirstParts {
  labels: Uint16Array;
  heights_m: number[];
}

/** Return the parts that the program proposes for a picture that nobody has divided; null if it finds one alone. */
export async function firstParts(net: Server): Promise<FirstParts | null> {
  const { labels, heights_m } = await net.ask<{ labels: string; heights_m: number[] }>("parts_first");
  if (heights_m.length < 2) return null;
  const data = await bulk(`/scene/${labels}`).then((each) => each.arrayBuffer());
  return { heights_m, labels: new Uint16Array(data) };
}

export const proposePart = (net: Server, points: readonly Point[], width_px: number, how: HowToPropose): Promise<Proposal | null> =>
  net.ask("parts_propose", { points: whole(points), width_px: Math.max(1, Math.round(width_px)), within: null, ...how });

export async function snapOutline(net: Server, points: readonly Point[], reach_px: number): Promise<Point[]> {
  const answer = await net.ask<{ points: Point[] }>("parts_snap", { points: whole(points), reach_px: Math.max(1, Math.round(reach_px)) });
  return answer.points;
}

/** Save parts: their labels as a compressed file, then their properties. */
export async function saveParts(net: Server, labels: Labels, parts: readonly Part[], args: Record<string, unknown>): Promise<Saved> {
  const upload = await net.ask<string>("batch");
  const gzip = new Blob([labels.data as Uint16Array<ArrayBuffer>]).stream().pipeThrough(new CompressionStream("gzip"));
  const response = await fetch(`/upload/${upload}/labels.gz?token=${encodeURIComponent(token)}&language=${ours}`, {
    method: "PUT",
    body: await new Response(gzip).blob(),
  });
  if (!response.ok) throw new Error(await response.text());
  const said = parts.map(({ label, name, height_m, material, automatic }) => {
    return { label, name, height_m: automatic ? null : height_m, material };
  });
  return net.ask<Saved>("parts_save", { upload, parts: said, ...args });
}

const whole = (points: readonly Point[]): number[][] => points.map((each) => each.map((part) => Math.round(10 * part) / 10));
