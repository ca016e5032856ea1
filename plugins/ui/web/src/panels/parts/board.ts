/** The picture with its parts: borders, numbers and names over it, and what a tool is doing. Drawn as large as the screen. */
import { measuring } from "../../measure";
import { colour } from "../../themes";
import { borders, rimOf } from "./borders";
import type { Drawing } from "./drawing";
import { around, type Box, EMPTY, isEmpty, type Point } from "./labels";
import type { Place } from "./pieces";
import { Sight } from "./sight";

/** What a tool shows while it is used. */
export interface Marks {
  line: readonly Point[];
  closed: boolean;
  /** Where the pointer or the crosshair is, in the picture. */
  at: Point | null;
  cross: boolean;
  /** In pixels of the picture; 0 for none. */
  brush: number;
}

export interface Named {
  text: string;
  place: Place;
  label: number;
}

const TEXT_PX = 13;
/** Smaller parts on the board have no name on it. */
const SMALLEST_PX = 12;
const DARK = "#0b0e13";
const LIGHT = "#ffffff";

export class Board {
  readonly element = document.createElement("div");
  /** The uppermost canvas, which has the focus and hears the pointers. */
  readonly canvas: HTMLCanvasElement;
  readonly sight: Sight;
  marks: Marks = { line: [], closed: false, at: null, cross: false, brush: 0 };
  /** The largest first. */
  names: Named[] = [];
  private layers: CanvasRenderingContext2D[];
  private ratio = 1;
  private stale: Box = EMPTY;
  private moved = true;
  private due = false;
  private since = 0;
  private accent = { css: LIGHT, ink: DARK, pixel: 0, thin: 0 };
  private watching = new ResizeObserver(() => this.resize());

  constructor(
    private drawing: Drawing,
    private picture: ImageBitmap,
  ) {
    this.sight = new Sight(drawing.labels.columns, drawing.labels.rows);
    this.element.className = "board";
    const canvases = [0, 1, 2].map(() => document.createElement("canvas"));
    this.canvas = canvases[2]!;
    this.layers = canvases.map((each) => each.getContext("2d")!);
    this.element.append(...canvases);
    this.watching.observe(this.element);
  }

  close(): void {
    this.watching.disconnect();
    this.picture.close();
  }

  /** The colours are others. */
  dress(): void {
    const [r, g, b] = colour("--accent").match(/\d+/g)!.map(Number) as [number, number, number];
    const pixel = ((b << 16) | (g << 8) | r) >>> 0;
    this.accent = { css: colour("--accent"), ink: colour("--accent-ink"), pixel: (pixel | 0xff000000) >>> 0, thin: (pixel | 0x40000000) >>> 0 };
    this.look();
  }

  /** Something of the picture's parts is another; at: when it was asked for. */
  changed(box: Box, at = performance.now()): void {
    this.stale = around(this.stale, box);
    this.since ||= at;
    this.wake();
  }

  /** What is seen is another. */
  look(): void {
    this.moved = true;
    this.wake();
  }

  /** What a tool shows is another. */
  mark(marks: Partial<Marks>): void {
    Object.assign(this.marks, marks);
    this.wake();
  }

  /** A place of the window, in the picture. */
  at({ clientX, clientY }: { clientX: number; clientY: number }): Point {
    return this.sight.toPicture(this.onBoard(clientX, clientY));
  }

  onBoard(clientX: number, clientY: number): Point {
    const { left, top } = this.canvas.getBoundingClientRect();
    return [(clientX - left) * this.ratio, (clientY - top) * this.ratio];
  }

  /** Pixels of the picture for one of the page. */
  get scale(): number {
    return this.ratio / this.sight.zoom;
  }

  private resize(): void {
    this.ratio = Math.max(1, devicePixelRatio);
    const [width, height] = [this.element.clientWidth, this.element.clientHeight].map((each) => Math.max(1, Math.round(each * this.ratio)));
    for (const { canvas } of this.layers) Object.assign(canvas, { width, height });
    this.sight.resize(width!, height!);
    this.moved = true;
    this.draw(); // at once: a canvas of another size is empty
  }

  private wake(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draw();
    });
  }

  private draw(): void {
    const { sight, moved } = this;
    const whole = { left: 0, top: 0, right: sight.width, bottom: sight.height };
    if (moved) this.drawPicture();
    const box = moved ? whole : sight.covering(this.stale, rimOf(this.ratio));
    if (!isEmpty(box)) this.drawBorders(box);
    this.moved = false;
    this.stale = EMPTY;
    this.drawMarks();
    if (measuring && this.since) this.measured(this.since);
    this.since = 0;
  }

  private measured(start: number): void {
    setTimeout(() => performance.measure("parts shown", { start, end: performance.now() }));
  }

  private drawPicture(): void {
    const [context] = this.layers;
    const { sight, drawing, picture } = this;
    const { columns, rows } = drawing.labels;
    context!.setTransform(1, 0, 0, 1, 0, 0);
    context!.clearRect(0, 0, sight.width, sight.height);
    context!.imageSmoothingEnabled = sight.zoom < 3;
    const [x, y] = sight.toBoard([0, 0]);
    context!.drawImage(picture, x, y, columns * sight.zoom, rows * sight.zoom);
  }

  private drawBorders(box: Box): void {
    const { labels, selected, proposed } = this.drawing;
    const { pixel: accent, thin } = this.accent;
    const image = borders({ labels, selected, proposed, accent, thin, ratio: this.ratio }, this.sight, box);
    this.layers[1]!.putImageData(image, box.left, box.top);
  }

  private drawMarks(): void {
    const context = this.layers[2]!;
    context.clearRect(0, 0, this.sight.width, this.sight.height);
    this.drawNames(context);
    const { line, closed, at, cross, brush } = this.marks;
    if (line.length > 1) {
      const path = new Path2D();
      line.forEach((each, i) => path[i ? "lineTo" : "moveTo"](...this.sight.toBoard(each)));
      if (closed) path.closePath();
      this.trace(context, path);
    }
    if (!at) return;
    const [x, y] = this.sight.toBoard(at);
    const ring = new Path2D();
    if (brush) ring.arc(x, y, Math.max(2, (brush / 2) * this.sight.zoom), 0, 2 * Math.PI);
    if (cross) for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
      ring.moveTo(x + 5 * dx * this.ratio, y + 5 * dy * this.ratio);
      ring.lineTo(x + 18 * dx * this.ratio, y + 18 * dy * this.ratio);
    }
    this.trace(context, ring);
  }

  /** A light line in a dark one. */
  private trace(context: CanvasRenderingContext2D, path: Path2D): void {
    for (const [style, width] of [[DARK, 3.5], [LIGHT, 1.5]] as const) {
      context.strokeStyle = style;
      context.lineWidth = width * this.ratio;
      context.stroke(path);
    }
  }

  /** Names that would lie over another one are left out; the selected part's never is. */
  private drawNames(context: CanvasRenderingContext2D): void {
    const { selected } = this.drawing;
    context.font = `600 ${TEXT_PX * this.ratio}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    const taken: Box[] = [];
    const first = this.names.filter(({ label }) => label === selected);
    for (const named of [...first, ...this.names.filter(({ label }) => label !== selected)]) {
      const chosen = named.label === selected;
      if (!chosen && Math.sqrt(named.place.pixels) * this.sight.zoom < SMALLEST_PX * this.ratio) continue;
      this.drawName(context, named, chosen, taken);
    }
  }

  private drawName(context: CanvasRenderingContext2D, { text, place }: Named, chosen: boolean, taken: Box[]): void {
    const [x, y] = this.sight.toBoard(place.at);
    const half = context.measureText(text).width / 2 + 6 * this.ratio;
    const tall = 0.75 * TEXT_PX * this.ratio;
    const box = { left: x - half, right: x + half, top: y - tall, bottom: y + tall };
    if (box.right < 0 || box.left > this.sight.width || box.bottom < 0 || box.top > this.sight.height) return;
    if (taken.some((each) => each.left < box.right && box.left < each.right && each.top < box.bottom && box.top < each.bottom)) return;
    taken.push(box);
    context.beginPath();
    context.roundRect(box.left, box.top, 2 * half, 2 * tall, tall);
    context.globalAlpha = chosen ? 1 : 0.72;
    context.fillStyle = chosen ? this.accent.css : DARK;
    context.fill();
    context.globalAlpha = 1;
    if (chosen) {
      context.strokeStyle = this.accent.ink;
      context.lineWidth = 2 * this.ratio;
      context.stroke();
    }
    context.fillStyle = chosen ? this.accent.ink : LIGHT;
    context.fillText(text, x, y + this.ratio / 2);
  }
}
