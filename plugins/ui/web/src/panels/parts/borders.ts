/** Borders of the parts as pixels of the board: a dark line beside a light one, which is seen on every picture. */
import type { Box, Labels } from "./labels";
import type { Mask } from "./mask";
import type { Sight } from "./sight";

const DARK = 0xd0000000;
const LIGHT = 0xe6ffffff;
const FAINT_DARK = 0x66000000;
const FAINT_LIGHT = 0x80ffffff;
/** How far apart the stripes are that lie over the selected part, and over what is proposed. */
const STRIPES = { selected: 18, proposed: 8 };

export interface Shown {
  labels: Labels;
  selected: number;
  proposed: Mask | null;
  /** Of the theme, as a pixel; and the same, thin. */
  accent: number;
  thin: number;
  /** Pixels of the board for one of the page. */
  ratio: number;
}

const BESIDE = -1;
const PROPOSED = 0x10000;

/** Samples with a rim, kept from one time to the next. */
let samples = new Int32Array(0);

/** How far around what changed the lines can change too. */
export const rimOf = (ratio: number): number => 2 * Math.round(ratio) + 1;

export function borders(shown: Shown, sight: Sight, box: Box): ImageData {
  const rim = rimOf(shown.ratio);
  const [width, height] = [box.right - box.left, box.bottom - box.top];
  const stride = width + 2 * rim;
  sample(shown, sight, { left: box.left - rim, top: box.top - rim, right: box.right + rim, bottom: box.bottom + rim });
  const image = new ImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const thick = Math.round(shown.ratio);
  for (let y = 0; y < height; y++) {
    let at = (y + rim) * stride + rim;
    for (let x = 0; x < width; x++, at++) pixels[y * width + x] = pixel(at, stride, thick, shown, box.left + x, box.top + y);
  }
  return image;
}

function sample({ labels, proposed }: Shown, sight: Sight, box: Box): void {
  const { columns, rows, data } = labels;
  const width = box.right - box.left;
  const count = width * (box.bottom - box.top);
  if (samples.length < count) samples = new Int32Array(count);
  const xs = Int32Array.from({ length: width }, (_, i) => Math.floor(sight.left + (box.left + i + 0.5) / sight.zoom));
  let at = 0;
  for (let y = box.top; y < box.bottom; y++) {
    const row = Math.floor(sight.top + (y + 0.5) / sight.zoom);
    const inside = row >= 0 && row < rows;
    for (let i = 0; i < width; i++) {
      const x = xs[i]!;
      if (!inside || x < 0 || x >= columns) samples[at++] = BESIDE;
      else samples[at++] = proposed?.data[row * columns + x] ? PROPOSED : data[row * columns + x]!;
    }
  }
}

function pixel(at: number, stride: number, thick: number, shown: Shown, x: number, y: number): number {
  const here = samples[at]!;
  if (here === BESIDE) return 0;
  const mine = here === PROPOSED || here === shown.selected;
  const far = mine ? 2 * thick : thick;
  const right = samples[at + far]!;
  const below = samples[at + far * stride]!;
  const left = samples[at - far]!;
  const above = samples[at - far * stride]!;
  const rim = right !== here || below !== here || left !== here || above !== here;
  if (here === PROPOSED) return rim ? (((x + y) >> 2) & 1 ? DARK : LIGHT) : striped(x - y, STRIPES.proposed * thick, thick, shown.thin);
  if (mine) return rim ? shown.accent : striped(x + y, STRIPES.selected * thick, thick, 0);
  if (right !== here || below !== here) return DARK;
  return rim ? LIGHT : 0;
}

function striped(along: number, period: number, thick: number, otherwise: number): number {
  const at = ((along % period) + period) % period;
  return at < thick ? FAINT_LIGHT : at < 2 * thick ? FAINT_DARK : otherwise;
}
