/** Details saved along with the parts: title, language and the shape of all parts. */

export type Heights = { by: "depth" | "given" | "guess"; round_m: number; bulge_m: number; detail_m: number };
/** Title, language and the shape of all parts, which are saved along with them. */
export interface PictureDetails {
  heights: Heights;
  title: string;
  language: string;
}

/** Lengths that give parts their shape, metres. */
export const SHAPES = ["round_m", "bulge_m", "detail_m"] as const;

/** Return the shape rounded to a hundredth of a millimetre, as the editor's fields show it. */
export function roundShapes(heights: Heights): Pick<Heights, (typeof SHAPES)[number]> {
  const [round_m, bulge_m, detail_m] = SHAPES.map((name) => Math.round(1e5 * heights[name]) / 1e5) as [number, number, number];
  return { round_m, bulge_m, detail_m };
}
