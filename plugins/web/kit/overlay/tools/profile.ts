/** Profile of heights along a ruler, with axes in millimetres. */
import { notation } from "../../words/words";
import { t } from "../words";
import type { Measurement } from "./measurement";
import { roundDown125 } from "../settings";

const NS = "http://www.w3.org/2000/svg";
const SIZE = { width: 230, height: 118, left: 34, right: 8, top: 8, bottom: 32 };
const MARKS = 4;
const MAX_POINTS = 500;

/** Return round numbers within a span, in millimetres. */
export function marks(lowMm: number, highMm: number): number[] {
  const step = roundDown125((highMm - lowMm) / MARKS) || 1;
  const first = Math.ceil(lowMm / step - 1e-9);
  const last = Math.floor(highMm / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(6)));
}

export function profile(measured: Measurement): SVGSVGElement {
  const heights = Array.from(measured.heightsM, (each) => 1000 * each).filter(Number.isFinite);
  const far = Math.max(1000 * measured.horizontalM, 1e-6);
  const [low, high] = span(heights);
  const x = (mm: number): number => SIZE.left + (mm / far) * (SIZE.width - SIZE.left - SIZE.right);
  const y = (mm: number): number => SIZE.height - SIZE.bottom - ((mm - low) / (high - low)) * (SIZE.height - SIZE.top - SIZE.bottom);
  const svg = make("svg", { viewBox: `0 0 ${SIZE.width} ${SIZE.height}`, role: "img", class: "profile" });
  svg.setAttribute("aria-label", t("profileSays", { mm: far.toFixed(1), low: Math.min(...heights).toFixed(2), high: Math.max(...heights).toFixed(2) }));
  for (const mm of marks(0, far)) svg.append(grid(x(mm), SIZE.top, x(mm), SIZE.height - SIZE.bottom), words(x(mm), SIZE.height - 20, "middle", mm));
  for (const mm of marks(low, high)) svg.append(grid(SIZE.left, y(mm), SIZE.width - SIZE.right, y(mm)), words(SIZE.left - 4, y(mm) + 3, "end", mm));
  const last = measured.heightsM.length - 1;
  const points: string[] = [];
  for (let i = 0, step = Math.max(1, Math.floor(last / MAX_POINTS)); i <= last; i += step)
    points.push(`${x((far * i) / last).toFixed(1)},${y(1000 * measured.heightsM[i]).toFixed(1)}`);
  svg.append(make("polyline", { points: points.join(" "), class: "heights" }));
  const unit = make("text", { x: `${SIZE.width - SIZE.right}`, y: `${SIZE.height - 5}`, "text-anchor": "end" });
  unit.textContent = t("profileAxes");
  svg.append(unit);
  return svg as SVGSVGElement;
}

/** Return lowest and highest height, a little apart if all are equal. */
function span(heights: number[]): [number, number] {
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  const more = Math.max(0.05 * (high - low), 0.01);
  return [low - more, high + more];
}

function grid(x1: number, y1: number, x2: number, y2: number): Element {
  return make("line", { x1: x1.toFixed(1), y1: y1.toFixed(1), x2: x2.toFixed(1), y2: y2.toFixed(1), class: "grid" });
}

function words(x: number, y: number, anchor: string, mm: number): Element {
  const text = make("text", { x: x.toFixed(1), y: y.toFixed(1), "text-anchor": anchor });
  text.textContent = notation(`${mm}`);
  return text;
}

function make(name: string, attributes: Record<string, string>): Element {
  const element = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}
