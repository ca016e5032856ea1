/** The part of the canvas that nothing covers: in it the surface is shown whole. */

export type Edge = "top" | "right" | "bottom";
/** Shares of the canvas that are covered, by edge. */
export type Covered = Record<Edge, number>;

/** Room between what covers the canvas and the surface, CSS pixels. */
const GAP_PX = 4;
/** Share from which something is not kept free of: too little would be left. */
const MOST = 0.45;
/** Shares are multiples of this: the surface is drawn anew for a step, and numbers that are read change their width often. */
const STEP = 1 / 32;

export class FreePart {
  private boxes = new Map<Element, Edge>();
  private shares: Covered = { top: 0, right: 0, bottom: 0 };
  private observer = new ResizeObserver(() => this.measure());
  private pressed = new Set<number>();

  /** changed: called with the shares whenever one of them is another, by `settle`, and no pointer is pressed on the canvas. */
  constructor(
    private canvas: HTMLElement,
    private changed: (covered: Covered) => void,
  ) {
    this.observer.observe(canvas);
    for (const type of ["pointerdown", "pointerup", "pointercancel"] as const)
      addEventListener(type, (event) => this.follow(event), { capture: true });
    addEventListener("toggle", () => this.measureSoon(), { capture: true }); // what is folded away is not observed
  }

  /** Keep the surface clear of an element at this edge, while it is shown. */
  keep(element: Element, edge: Edge): void {
    this.boxes.set(element, edge);
    this.observer.observe(element);
  }

  /** Leave the surface where it is under a hand that is pressed; what covers it is measured when the hand is let go. */
  private follow({ type, target, pointerId, isTrusted }: PointerEvent): void {
    if (!isTrusted) return;
    if (type !== "pointerdown") this.pressed.delete(pointerId);
    else if (target === this.canvas) this.pressed.add(pointerId);
    this.measureSoon();
  }

  /** Measure after the others who hear the same event: they look up what lies under the pointer, or hide what is folded. */
  private measureSoon(): void {
    setTimeout(() => this.measure());
  }

  private measure(): void {
    if (this.pressed.size) return;
    const shares = settle(this.shares, this.covered());
    if (shares === this.shares) return;
    this.shares = shares;
    this.changed(shares);
  }

  private covered(): Covered {
    const covered: Covered = { top: 0, right: 0, bottom: 0 };
    const canvas = this.canvas.getBoundingClientRect();
    for (const [element, edge] of this.boxes) {
      const share = shareOf(element.getBoundingClientRect(), canvas, edge);
      if (share <= MOST) covered[edge] = Math.max(covered[edge], share);
    }
    return covered;
  }
}

/** Return shares of whole steps that hold all that is covered; those of before if these hold it and are little larger. */
export function settle(before: Covered, covered: Covered): Covered {
  const edges = Object.keys(covered) as Edge[];
  const fits = (edge: Edge): boolean =>
    covered[edge] <= before[edge] && (covered[edge] > 0) === before[edge] > 0 && covered[edge] > before[edge] - 2 * STEP;
  if (edges.every(fits)) return before;
  const next = { ...before };
  for (const edge of edges) if (!fits(edge)) next[edge] = Math.ceil(covered[edge] / STEP) * STEP;
  return next;
}

/** Return the share of the canvas up to the far side of a box at this edge; 0 for a box without a size. */
export function shareOf(box: Omit<DOMRect, "toJSON">, canvas: Omit<DOMRect, "toJSON">, edge: Edge): number {
  if (!box.width || !box.height || !canvas.width || !canvas.height) return 0;
  if (edge === "right") return Math.max(0, canvas.right - box.left + GAP_PX) / canvas.width;
  return Math.max(0, (edge === "top" ? box.bottom - canvas.top : canvas.bottom - box.top) + GAP_PX) / canvas.height;
}
