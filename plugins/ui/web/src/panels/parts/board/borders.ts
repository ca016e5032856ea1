/** Borders of the parts as pixels of the board: a dark line beside a light one, which is seen on every picture. */
import type { Box, Labels } from "../pixels/labels";
import type { Mask } from "../pixels/mask";
import type { Sight } from "./viewport";

const DARK = 0xd0000000;
const LIGHT = 0xe6ffffff;
const FAINT_DARK = 0x66000000;
const FAINT_LIGHT = 0x80ffffff;
/** How far apart the stripes are that lie over the selected part, and over what is proposed. */
const STRIPES = { selected: 20, proposed: 8 };

export interface Shown {
  labels: Labels;
  selected: number;
  proposed: Mask | null;
  /** Of the theme, as a pixel; what stands on it; and the same, thin. */
  accent: number;
  against: number;
  thin: number;
  /** Pixels of the board for one of the page. */
  ratio: number;
}

const BESIDE = -1;
const PROPOSED = 0x10000;

/** Samples with a rim, kept from one time to the next. */
let samples = new Int32Array(0);

/** How thick a line is, in pixels of the board. */
const thickness = (ratio: number): number => Math.round(1.5 * ratio);

/** How far around what changed the lines can change too. */
export const rimOf = (ratio: number): number => 2 * thickness(ratio) + 1;

export function borders(shown: Shown, sight: Sight, box: Box): ImageData {
  const rim = rimOf(shown.ratio);
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
  const other = beyond(at, here === shown.selected ? thick + 1 : thick, stride, here);
  if (here === PROPOSED) return other !== here ? (((x + y) >> 2) & 1 ? DARK : LIGHT) : striped(x - y, STRIPES.proposed * thick, shown.ratio, shown.thin);
  if (here === shown.selected) return other !== here ? shown.accent : striped(x + y, STRIPES.selected * thick, shown.ratio, 0);
  if (other === here) return 0;
  if (other === shown.selected) return shown.against;
  return here > other ? LIGHT : DARK;
}

/** What lies on the other side of a border that is so near; the same, where none is. */
function beyond(at: number, far: number, stride: number, here: number): number {
  const right = samples[at + far]!;
  if (right !== here) return right;
  const below = samples[at + far * stride]!;
  if (below !== here) return below;
  const left = samples[at - far]!;
  return left !== here ? left : samples[at - far * stride]!;
}

function striped(along: number, period: number, thick: number, otherwise: number): number {
  const at = ((along % period) + period) % period;
  return at < thick ? FAINT_LIGHT : at < 2 * thick ? FAINT_DARK : otherwise;
}
