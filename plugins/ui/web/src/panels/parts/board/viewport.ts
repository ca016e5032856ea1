/** Which part of the picture is seen on the board, and how large. Pixels of the board are those of the screen. */
import type { Box, Point } from "../pixels/labels";

const NEAREST = 40;
/** A picture is never smaller than so much of the board. */
const SMALLEST = 0.5;

export class Sight {
  /** Pixels of the board for one of the picture. */
  zoom = 1;
  /** What of the picture is in the upper left corner of the board. */
  left = 0;
  top = 0;
  width = 1;
  height = 1;

  constructor(
    private columns: number,
    private rows: number,
  ) {}

  fit(): void {
    this.zoom = this.whole;
    this.left = (this.columns - this.width / this.zoom) / 2;
    this.top = (this.rows - this.height / this.zoom) / 2;
  }

  /** Nearer by a factor; what lies under a place of the board stays there. */
  nearer(factor: number, [x, y]: Point = [this.width / 2, this.height / 2]): void {
    const at = this.toPicture([x, y]);
    this.zoom = Math.max(SMALLEST * this.whole, Math.min(NEAREST, this.zoom * factor));
    this.left = at[0] - x / this.zoom;
    this.top = at[1] - y / this.zoom;
    this.hold();
  }

  pan(dx: number, dy: number): void {
    this.left -= dx / this.zoom;
    this.top -= dy / this.zoom;
    this.hold();
  }

  resize(width: number, height: number): void {
    const fitted = this.width === 1 || Math.abs(this.zoom / this.whole - 1) < 1e-6;
    const middle = this.toPicture([this.width / 2, this.height / 2]);
    this.width = width;
    this.height = height;
    if (fitted || this.zoom <= this.whole) return this.fit();
    this.left = middle[0] - width / this.zoom / 2;
    this.top = middle[1] - height / this.zoom / 2;
    this.hold();
  }

  /** Move as little as is needed for a place of the picture to be seen; whether it moved. */
  reveal([x, y]: Point): boolean {
    const before = [this.left, this.top];
    const rim = Math.min(this.width, this.height) / 12 / this.zoom;
    this.left = shown(this.left, this.width / this.zoom, x, rim, this.columns);
    this.top = shown(this.top, this.height / this.zoom, y, rim, this.rows);
    return before[0] !== this.left || before[1] !== this.top;
  }

  toPicture([x, y]: Point): Point {
    return [this.left + x / this.zoom, this.top + y / this.zoom];
  }

  toBoard([x, y]: Point): Point {
    return [(x - this.left) * this.zoom, (y - this.top) * this.zoom];
  }

  /** The pixels of the board that show a box of the picture and what is next to it. */
  covering({ left, top, right, bottom }: Box, rim: number): Box {
    const [x0, y0] = this.toBoard([left, top]);
    const [x1, y1] = this.toBoard([right, bottom]);
    return {
      left: Math.max(0, Math.floor(x0) - rim),
      top: Math.max(0, Math.floor(y0) - rim),
      right: Math.min(this.width, Math.ceil(x1) + rim),
      bottom: Math.min(this.height, Math.ceil(y1) + rim),
    };
  }

  private get whole(): number {
    return Math.min(this.width / this.columns, this.height / this.rows);
  }

  /** The middle of the board always shows something of the picture. */
  private hold(): void {
    const [w, h] = [this.width / this.zoom / 2, this.height / this.zoom / 2];
    this.left = Math.max(-w, Math.min(this.columns - w, this.left));
    this.top = Math.max(-h, Math.min(this.rows - h, this.top));
  }
}

/** The beginning of what is seen along an axis, so that a place is in it with a rim where there is more to see. */
function shown(from: number, length: number, at: number, rim: number, most: number): number {
  return Math.max(Math.min(most, at + rim) - length, Math.min(Math.max(0, at - rim), from));
}
