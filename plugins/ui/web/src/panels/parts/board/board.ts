/** The picture with borders, numbers and names of its parts, and the marks of the tool, at screen resolution. */
import { measuring } from "kit/instrumentation";
import { colour } from "kit/themes";
import { borders, borderReach } from "./borders";
import type { Drawing } from "../drawing/drawing";
import { union, type Box, EMPTY, isEmpty, type Point } from "../pixels/labels";
import type { Place } from "../pixels/pieces";
import { Viewport } from "./viewport";

/** Marks of a tool in use. */
export interface Marks {
  line: readonly Point[];
  closed: boolean;
  /** Position of pointer or crosshair in the picture. */
  at: Point | null;
  cross: boolean;
  /** Width of the brush in pixels of the picture; 0 for none. */
  brush: number;
}

export interface Named {
  text: string;
  place: Place;
  label: number;
}

const TEXT_REM = 0.8125;
/** Size below which a part has no name on the board. */
const SMALLEST_PX = 12;
const DARK = "#0b0e13";
const LIGHT = "#ffffff";

export class Board {
  readonly element = document.createElement("div");
  /** The visible canvas, opaque, which browsers draw fastest. */
  readonly canvas = document.createElement("canvas");
  readonly viewport: Viewport;
  marks: Marks = { line: [], closed: false, at: null, cross: false, brush: 0 };
  private context = this.canvas.getContext("2d", { alpha: false })!;
  /** Picture and borders at screen size, composed where something changed. */
  private base = hidden();
  private lines = hidden();
  private names: Named[] = [];
  private ground = DARK;
  private ratio = 1;
  private textPx = 13;
  private stale: Box = EMPTY;
  private moved = true;
  private anew = true;
  /** Box of the last marks. */
  private marked: Box = EMPTY;
  private due = false;
  private closed = false;
  private since = 0;
  private selected = -1;
  private accent = { css: LIGHT, ink: DARK, accent: 0, against: 0, thin: 0 };
  private watching = new ResizeObserver(() => this.resize());

  constructor(
    private drawing: Drawing,
    private picture: ImageBitmap,
  ) {
    this.viewport = new Viewport(drawing.labels.columns, drawing.labels.rows);
    this.element.className = "board";
    this.element.append(this.canvas);
    this.watching.observe(this.element);
  }

  close(): void {
    this.closed = true; // a frame may be pending
    this.watching.disconnect();
    this.picture.close();
  }

  /** Take over the theme's colours. */
  dress(): void {
    const css = colour("--accent");
    const wanted = colour("--accent-ink");
    const ink = wanted !== css ? wanted : isLight(css) ? DARK : LIGHT; // forced colours may be equal
    this.accent = { css, ink, accent: asPixel(css, 0xff), against: asPixel(ink, 0xe6), thin: asPixel(css, 0x40) };
    this.ground = getComputedStyle(this.element).backgroundColor;
    this.look();
  }

  /** Set the names on the parts, the largest first. */
  name(names: Named[]): void {
    this.names = names;
    this.anew = true;
    this.wake();
  }

  /** Redraw a box of the picture's parts. at: time of the event. */
  changed(box: Box, at = performance.now()): void {
    this.stale = union(this.stale, box);
    this.since ||= at;
    this.wake();
  }

  /** Redraw after the view changed. */
  look(): void {
    this.moved = true;
    this.wake();
  }

  /** Redraw the tool's marks. */
  mark(marks: Partial<Marks>): void {
    Object.assign(this.marks, marks);
    this.wake();
  }

  /** Return the place of the picture at a place of the window. */
  at({ clientX, clientY }: { clientX: number; clientY: number }): Point {
    return this.viewport.toPicture(this.onBoard(clientX, clientY));
  }

  onBoard(clientX: number, clientY: number): Point {
    const { left, top } = this.canvas.getBoundingClientRect();
    return [(clientX - left) * this.ratio, (clientY - top) * this.ratio];
  }

  /** Pixels of the picture per CSS pixel. */
  get scale(): number {
    return this.ratio / this.viewport.zoom;
  }

  private resize(): void {
    this.ratio = Math.max(1, devicePixelRatio);
    this.textPx = TEXT_REM * this.ratio * parseFloat(getComputedStyle(document.documentElement).fontSize);
    const [width, height] = [this.element.clientWidth, this.element.clientHeight].map((each) => Math.max(1, Math.round(each * this.ratio)));
    for (const { canvas } of [this.context, this.base, this.lines]) Object.assign(canvas, { width, height });
    this.viewport.resize(width!, height!);
    this.moved = true;
    this.draw(); // at once: a resized canvas is empty
  }

  private wake(): void {
    if (this.due) return;
    this.due = true;
    requestAnimationFrame(() => {
      this.due = false;
      this.draw();
    });
  }

  /** Draw, during a stroke only the changed box. */
  private draw(): void {
    if (this.closed) return;
    const { viewport, drawing } = this;
    const whole = { left: 0, top: 0, right: viewport.width, bottom: viewport.height };
    const anew = this.moved || this.selected !== drawing.selected;
    if (this.moved) this.drawPicture();
    const lines = anew ? whole : viewport.covering(this.stale, borderReach(this.ratio));
    if (!isEmpty(lines)) this.drawBorders(lines);
    const marks = this.marksBox();
    this.show(anew || this.anew ? whole : [lines, marks, this.marked].filter((each) => !isEmpty(each)).reduce(union, EMPTY));
    this.marked = marks;
    this.moved = this.anew = false;
    this.selected = drawing.selected;
    this.stale = EMPTY;
    if (measuring && this.since) this.markShown(this.since);
    this.since = 0;
  }

  /** Compose a box. */
  private show(box: Box): void {
    if (isEmpty(box)) return;
    const { context } = this;
    const at = [box.left, box.top, box.right - box.left, box.bottom - box.top] as const;
    context.save();
    context.beginPath();
    context.rect(...at);
    context.clip();
    for (const { canvas } of [this.base, this.lines]) context.drawImage(canvas, ...at, ...at);
    this.drawNames(context);
    this.drawMarks(context);
    context.restore();
  }

  private marksBox(): Box {
    const { line, at, brush } = this.marks;
    const { ratio, viewport } = this;
    const rim = Math.ceil(22 * ratio + (brush / 2) * viewport.zoom);
    let box = EMPTY;
    for (const each of at ? [...line, at] : line) {
      const [x, y] = viewport.toBoard(each);
      box = union(box, { left: x, top: y, right: x, bottom: y });
    }
    const within = (side: number, most: number): number => Math.max(0, Math.min(most, Math.round(side)));
    const [right, bottom] = [within(box.right + rim, viewport.width), within(box.bottom + rim, viewport.height)];
    return { left: within(box.left - rim, viewport.width), top: within(box.top - rim, viewport.height), right, bottom };
  }

  private markShown(start: number): void {
    setTimeout(() => performance.measure("parts shown", { start, end: performance.now() }));
  }

  private drawPicture(): void {
    const { viewport, drawing, picture, base } = this;
    const { columns, rows } = drawing.labels;
    base.fillStyle = this.ground;
    base.fillRect(0, 0, viewport.width, viewport.height);
    base.imageSmoothingEnabled = viewport.zoom < 3;
    const [x, y] = viewport.toBoard([0, 0]);
    base.drawImage(picture, x, y, columns * viewport.zoom, rows * viewport.zoom);
  }

  private drawBorders(box: Box): void {
    const { labels, selected, proposed } = this.drawing;
    const image = borders({ labels, selected, proposed, ...this.accent, ratio: this.ratio }, this.viewport, box);
    this.lines.putImageData(image, box.left, box.top);
  }

  private drawMarks(context: CanvasRenderingContext2D): void {
    const { line, closed, at, cross, brush } = this.marks;
    if (line.length > 1) {
      const path = new Path2D();
      line.forEach((each, i) => path[i ? "lineTo" : "moveTo"](...this.viewport.toBoard(each)));
      if (closed) path.closePath();
      this.trace(context, path);
    }
    if (!at) return;
    const [x, y] = this.viewport.toBoard(at);
    const ring = new Path2D();
    if (brush) ring.arc(x, y, Math.max(2, (brush / 2) * this.viewport.zoom), 0, 2 * Math.PI);
    if (cross) for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]] as const) {
      ring.moveTo(x + 5 * dx * this.ratio, y + 5 * dy * this.ratio);
      ring.lineTo(x + 18 * dx * this.ratio, y + 18 * dy * this.ratio);
    }
    this.trace(context, ring);
  }

  /** Draw a light line in a dark one. */
  private trace(context: CanvasRenderingContext2D, path: Path2D): void {
    for (const [style, width] of [[DARK, 3.5], [LIGHT, 1.5]] as const) {
      context.strokeStyle = style;
      context.lineWidth = width * this.ratio;
      context.stroke(path);
    }
  }

  /** Draw names that do not overlap; the selected part's comes first. */
  private drawNames(context: CanvasRenderingContext2D): void {
    const { selected } = this.drawing;
    context.font = `600 ${this.textPx}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    const taken: Box[] = [];
    const first = this.names.filter(({ label }) => label === selected);
    for (const named of [...first, ...this.names.filter(({ label }) => label !== selected)]) {
      const chosen = named.label === selected;
      if (!chosen && Math.sqrt(named.place.pixels) * this.viewport.zoom < SMALLEST_PX * this.ratio) continue;
      this.drawName(context, named, chosen, taken);
    }
  }

  private drawName(context: CanvasRenderingContext2D, { text, place }: Named, chosen: boolean, taken: Box[]): void {
    const [x, y] = this.viewport.toBoard(place.at);
    const half = context.measureText(text).width / 2 + 6 * this.ratio;
    const tall = 0.75 * this.textPx;
    const box = { left: x - half, right: x + half, top: y - tall, bottom: y + tall };
    if (box.right < 0 || box.left > this.viewport.width || box.bottom < 0 || box.top > this.viewport.height) return;
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

/** Return rgb(...) or six digits as four bytes. */
function asPixel(css: string, alpha: number): number {
  const [r, g, b] = bytes(css);
  return ((alpha << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

function bytes(css: string): [number, number, number] {
  if (css.startsWith("#")) return [1, 3, 5].map((at) => parseInt(css.slice(at, at + 2), 16)) as [number, number, number];
  return css.match(/[\d.]+/g)!.map(Number) as [number, number, number];
}

const isLight = (css: string): boolean => bytes(css).reduce((sum, each) => sum + each) > 382;

function hidden(): CanvasRenderingContext2D {
  return document.createElement("canvas").getContext("2d")!;
}
