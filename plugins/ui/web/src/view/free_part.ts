/** The part of the canvas that nothing covers: in it the surface is shown whole. */

export type Edge = "top" | "right" | "bottom";
/** Shares of the canvas that are covered, by edge. */
export type Covered = Record<Edge, number>;

/** Room between what covers the canvas and the surface, CSS pixels. */
const GAP_PX = 4;
/** Share from which something is not kept free of: too little would be left. */
const MOST = 0.45;

export class FreePart {
  private boxes = new Map<Element, Edge>();
  private observer = new ResizeObserver(() => this.changed(this.covered()));

  /** changed: called with the shares whenever the canvas or what covers it changes its size. */
  constructor(
    private canvas: HTMLElement,
    private changed: (covered: Covered) => void,
  ) {
    this.observer.observe(canvas);
  }

  /** Keep the surface clear of an element at this edge, while it is shown. */
  keep(element: Element, edge: Edge): void {
    this.boxes.set(element, edge);
    this.observer.observe(element);
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

/** Return the share of the canvas up to the far side of a box at this edge; 0 for a box without a size. */
export function shareOf(box: Omit<DOMRect, "toJSON">, canvas: Omit<DOMRect, "toJSON">, edge: Edge): number {
  if (!box.width || !box.height || !canvas.width || !canvas.height) return 0;
  if (edge === "right") return Math.max(0, canvas.right - box.left + GAP_PX) / canvas.width;
  return Math.max(0, (edge === "top" ? box.bottom - canvas.top : canvas.bottom - box.top) + GAP_PX) / canvas.height;
}
