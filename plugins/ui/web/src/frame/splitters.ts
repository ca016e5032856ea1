/** Splitters between regions, moved by the pointer or the arrow keys; the sizes are kept. */
import { recall, remember } from "kit/preferences";
import { t } from "./words";

interface Split {
  /** The region that it sizes, by the token --left, --right, --bottom. */
  region: "left" | "right" | "bottom";
  upright: boolean;
  /** 1 if the region grows to the right or down, else -1. */
  way: 1 | -1;
}

const SPLITS: Split[] = [
  { region: "left", upright: true, way: 1 },
  { region: "right", upright: true, way: -1 },
  { region: "bottom", upright: false, way: -1 },
];
const STEP_PX = 16;
const MIN_PX = 80;
const KEYS: Record<string, number> = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 };

export function buildSplitters(): void {
  document.getElementById("sizes")!.setAttribute("aria-label", t("sizes"));
  for (const split of SPLITS) splitters.push(new Splitter(split));
}

/** Reset the sizes of all regions. */
export function resetSizes(): void {
  for (const { region } of SPLITS) {
    remember(region, 0);
    document.documentElement.style.removeProperty(`--${region}`);
  }
}

/** Enlarge all regions by some steps; shrink them if negative. */
export function resize(steps: number): void {
  for (const line of splitters) line.step(4 * steps);
}

const splitters: Splitter[] = [];

class Splitter {
  private line: HTMLElement;
  private region: HTMLElement;

  constructor(private split: Split) {
    this.line = document.getElementById(`split-${split.region}`)!;
    this.region = document.getElementById(split.region)!;
    this.line.tabIndex = 0;
    const told = { role: "separator", "aria-label": t(`${split.region}Size`), "aria-controls": split.region };
    for (const [name, value] of Object.entries(told)) this.line.setAttribute(name, value);
    this.line.setAttribute("aria-orientation", split.upright ? "vertical" : "horizontal");
    this.line.addEventListener("keydown", (event) => this.key(event));
    this.line.addEventListener("pointerdown", (event) => this.drag(event));
    this.line.addEventListener("dblclick", () => resetSizes());
    new ResizeObserver(() => this.tell()).observe(this.region);
    const kept = recall(split.region, 0);
    if (kept) this.setSize(kept);
  }

  private get size(): number {
    return this.split.upright ? this.region.offsetWidth : this.region.offsetHeight;
  }

  private key(event: KeyboardEvent): void {
    const step = KEYS[event.key];
    if (!step || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    this.step(step * this.split.way);
  }

  step(steps: number): void {
    this.setSize(this.size + steps * STEP_PX);
    remember(this.split.region, this.size);
  }

  private drag(begun: PointerEvent): void {
    const { upright, way, region } = this.split;
    const along = (event: PointerEvent): number => (upright ? event.clientX : event.clientY);
    const [first, size] = [along(begun), this.size];
    const move = (event: PointerEvent): void => this.setSize(size + way * (along(event) - first));
    this.line.setPointerCapture(begun.pointerId);
    this.line.classList.add("moving");
    this.line.addEventListener("pointermove", move);
    const end = (): void => {
      this.line.classList.remove("moving");
      this.line.removeEventListener("pointermove", move);
      remember(region, this.size);
    };
    this.line.addEventListener("lostpointercapture", end, { once: true });
  }

  private setSize(px: number): void {
    const whole = this.split.upright ? innerWidth : innerHeight;
    const kept = Math.round(Math.min(Math.max(px, MIN_PX), 0.6 * whole));
    document.documentElement.style.setProperty(`--${this.split.region}`, `${kept}px`);
  }

  private tell(): void {
    const whole = this.split.upright ? innerWidth : innerHeight;
    this.line.setAttribute("aria-valuenow", String(Math.round((100 * this.size) / whole)));
  }
}
