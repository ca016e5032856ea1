/** A C2 surface: a cubic B-spline over a grid of equal cells, as the force laws of the program have it.
 *
 * The counterpart of tangible_render/surface/spline.py: BORDER rows and columns of coefficients more than there are
 * cells on each side. Source: Unser, Aldroubi & Eden, B-spline signal processing, IEEE Trans. Signal Processing 41 (1993). */
import { Grid } from "kit/surface/grid";

export const BORDER = 2;

/** Height, gradient and Hessian at a place: h, h_x, h_y, h_xx, h_xy, h_yy. */
export type Expansion = readonly [number, number, number, number, number, number];
type Four = readonly [number, number, number, number];

export class Spline {
  readonly acrossPerM: number;
  readonly downPerM: number;

  /** coefficients: rows x columns, metres, row 0 far. */
  constructor(
    readonly coefficients: Float32Array,
    readonly rows: number,
    readonly columns: number,
    readonly widthM: number,
    readonly lengthM: number,
  ) {
    this.acrossPerM = (columns - 2 * BORDER) / widthM;
    this.downPerM = (rows - 2 * BORDER) / lengthM;
  }

  height(x: number, y: number): number {
    const { at, down, across } = this.place(x, y);
    return dot(this.blend(at, values(down)), values(across));
  }

  bend(x: number, y: number): Expansion {
    const { acrossPerM, downPerM } = this;
    const { at, down, across } = this.place(x, y);
    const [line, rise, curve] = [values(down), slopes(down), bends(down)].map((weights) => this.blend(at, weights)) as [Four, Four, Four];
    const [value, tilt] = [values(across), slopes(across)];
    return [
      dot(line, value),
      dot(line, tilt) * acrossPerM,
      -dot(rise, value) * downPerM,
      dot(line, bends(across)) * acrossPerM * acrossPerM,
      -dot(rise, tilt) * acrossPerM * downPerM,
      dot(curve, value) * downPerM * downPerM,
    ];
  }

  /** Return the heights at the centres of the cells, to be drawn and described. */
  centres(): Grid {
    const { coefficients, widthM, lengthM, rows: all, columns: wide } = this;
    const [rows, columns] = [all - 2 * BORDER, wide - 2 * BORDER];
    const heights = new Float32Array(rows * columns);
    for (let j = 0, k = 0; j < rows; j++)
      for (let i = 0; i < columns; i++, k++) {
        const at = (j + BORDER) * wide + i + BORDER;
        const sides = coefficients[at - 1]! + coefficients[at + 1]! + coefficients[at - wide]! + coefficients[at + wide]!;
        const corners =
          coefficients[at - wide - 1]! + coefficients[at - wide + 1]! + coefficients[at + wide - 1]! + coefficients[at + wide + 1]!;
        heights[k] = (16 * coefficients[at]! + 4 * sides + corners) / 36;
      }
    return new Grid(heights, rows, columns, { left: -widthM / 2, far: lengthM / 2, dx: widthM / columns, dy: lengthM / rows });
  }

  private place(x: number, y: number): { at: number; down: number; across: number } {
    const { rows, columns } = this;
    const down = 0.5 * (rows - 1) - y * this.downPerM;
    const across = 0.5 * (columns - 1) + x * this.acrossPerM;
    const row = Math.min(Math.max(Math.trunc(down), 1), rows - 3);
    const column = Math.min(Math.max(Math.trunc(across), 1), columns - 3);
    return { at: (row - 1) * columns + column - 1, down: down - row, across: across - column };
  }

  /** Return the weighted sums of four rows, one for each of four columns. */
  private blend(at: number, [a, b, c, d]: Four): Four {
    const { coefficients: all, columns } = this;
    const sum = (k: number): number => a * all[k]! + b * all[k + columns]! + c * all[k + 2 * columns]! + d * all[k + 3 * columns]!;
    return [sum(at), sum(at + 1), sum(at + 2), sum(at + 3)];
  }
}

function values(t: number): Four {
  const u = 1 - t;
  const [first, last, second] = [(u * u * u) / 6, (t * t * t) / 6, 2 / 3 - t * t * (1 - 0.5 * t)];
  return [first, second, 1 - first - second - last, last];
}

function slopes(t: number): Four {
  const u = 1 - t;
  return [-0.5 * u * u, t * (1.5 * t - 2), u * (2 - 1.5 * u), 0.5 * t * t];
}

const bends = (t: number): Four => [1 - t, 3 * t - 2, 1 - 3 * t, t];
const dot = (a: Four, b: Four): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
