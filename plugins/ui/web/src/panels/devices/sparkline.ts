/** A line of the last values, and what it says in words. */
import { t } from "./words";

const KEPT = 60;
const NAMESPACE = "http://www.w3.org/2000/svg";

export class Spark {
  readonly element = document.createElementNS(NAMESPACE, "svg");
  private line = document.createElementNS(NAMESPACE, "polyline");
  private values: number[] = [];

  constructor(private name: string, private digits: number) {
    this.element.setAttribute("class", "spark");
    this.element.setAttribute("viewBox", `0 0 ${KEPT - 1} 1`);
    this.element.setAttribute("preserveAspectRatio", "none");
    this.element.setAttribute("role", "img");
    this.element.append(this.line);
  }

  add(value: number): void {
    this.values = [...this.values, value].slice(-KEPT);
    this.line.setAttribute("points", points(this.values));
    const said = { name: this.name, now: value.toFixed(this.digits), most: Math.max(...this.values).toFixed(this.digits) };
    this.element.setAttribute("aria-label", t("line", said));
  }
}

/** From left to right, the newest at the right; from 0 up to the greatest. */
export function points(values: number[], kept = KEPT): string {
  const most = Math.max(...values, Number.MIN_VALUE);
  return values.map((value, i) => `${kept - values.length + i},${(1 - value / most).toFixed(3)}`).join(" ");
}
