/** Borders of the parts as pixels of the board: a dark line next to a light one, visible on every picture. */
import type { Box, Labels } from "../pixels/labels";
import type { Mask } from "../pixels/mask";
import type { Viewport } from "./viewport";

const DARK = 0xd0000000;
const LIGHT = 0xe6ffffff;
const FAINT_DARK = 0x66000000;
const FAINT_LIGHT = 0x80ffffff;
/** Distances of the stripes over the selected part and the proposal, in line widths. */
const STRIPES = { selected: 20, proposed: 8 };

export interface BorderStyle {
  labels: Labels;
  selected: number;
  proposed: Mask | null;
  /** Theme colours as pixels: accent, its contrast, and a translucent accent. */
  accent: number;
  against: number;
  thin: number;
  /** Pixels of the board per CSS pixel. */
  ratio: number;
}

const OUTSIDE = -1;
const PROPOSED = 0x10000;

/** Buffer of samples with a rim, reused. */
let samples = new Int32Array(0);

/** Return the width of a line, pixels of the board. */
const thickness = (ratio: number): number => Math.round(1.5 * ratio);

/** Return the distance from a change at which lines can change too. */
export const borderReach = (ratio: number): number => 2 * thickness(ratio) + 1;

export function borders(shown: BorderStyle, sight: Viewport, box: Box): ImageData {
  const rim = borderReach(shown.ratio);
  const [width, height] = [box.right - box.left, box.bottom - box.top];
  const stride = width + 2 * rim;
  sample(shown, sight, { left: box.left - rim, top: box.top - rim, right: box.right + rim, bottom: box.bottom + rim });
  const image = new ImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const thick = thickness(shown.ratio);
  for (let y = 0; y < height; y++) {
    let at = (y + rim) * stride + rim;
    for (let x = 0; x < width; x++, at++) pixels[y * width + x] = pixel(at, stride, thick, shown, box.left + x, box.top + y);
  }
  return image;
}

function sample({ labels, proposed }: BorderStyle, sight: Viewport, box: Box): void {
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
      if (!inside || x < 0 || x >= columns) samples[at++] = OUTSIDE;
      else samples[at++] = proposed?.data[row * columns + x] ? PROPOSED : data[row * columns + x]!;
    }
  }
}

function pixel(at: number, stride: number, thick: number, shown: BorderStyle, x: number, y: number): number {
  const here = samples[at]!;
  if (here === OUTSIDE) return 0;
  const other = labelAcross(at, here === shown.selected ? thick + 1 : thick, stride, here);
  if (here === PROPOSED) return other !== here ? (((x + y) >> 2) & 1 ? DARK : LIGHT) : stripe(x - y, STRIPES.proposed * thick, shown.ratio, shown.thin);
  if (here === shown.selected) return other !== here ? shown.accent : stripe(x + y, STRIPES.selected * thick, shown.ratio, 0);
  if (other === here) return 0;
  if (other === shown.selected) return shown.against;
  return here > other ? LIGHT : DARK;
}

/** Return the label across a border nearby; the same label if there is none. */
function labelAcross(at: number, far: number, stride: number, here: number): number {
  const right = samples[at + far]!;
  if (right !== here) return right;
  const below = samples[at + far * stride]!;
  if (below !== here) return below;
  const left = samples[at - far]!;
  return left !== here ? left : samples[at - far * stride]!;
}

function stripe(along: number, period: number, thick: number, otherwise: number): number {
  const at = ((along % period) + period) % period;
  return at < thick ? FAINT_LIGHT : at < 2 * thick ? FAINT_DARK : otherwise;
}
