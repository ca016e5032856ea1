/** A handle on the surface: a button moved by the pointer or the arrow keys. */
import type { Page } from "../../page";
import type { Vec } from "../../server/protocol";

export const STEP_M = 0.0005;
export const COARSE = 10;
const DIRECTIONS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
  "-": [-1, -1],
  "+": [1, 1],
};

export interface HandleTarget {
  /** Return the handle's place; null while it is hidden. */
  at(): Vec | null;
  /** Called when the pointer drags it to a place on the surface. */
  drag(to: Vec): void;
  /** Called for steps by keys, right and away from the user; Shift makes ten of one. */
  nudge(right: number, away: number): void;
  /** Called when the handle or the key is released. */
  done?(): void;
}

export class Handle {
  readonly element = document.createElement("button");
  private away: () => void;

  constructor(
    private page: Pick<Page, "view" | "overlay" | "scene">,
    shape: "round" | "square" | "turn" | "move",
    label: string,
    private grasped: HandleTarget,
  ) {
    this.element.type = "button";
    this.element.className = `handle ${shape}`;
    this.element.setAttribute("aria-label", label);
    this.element.title = label;
    this.element.onpointerdown = (event) => this.element.setPointerCapture(event.pointerId);
    this.element.onpointermove = (event) => this.onDrag(event);
    this.element.onlostpointercapture = () => grasped.done?.();
    this.element.onkeydown = (event) => this.onKey(event);
    this.element.onkeyup = (event) => {
      if (DIRECTIONS[event.key]) grasped.done?.();
    };
    this.away = page.overlay.stay(this.element, () => grasped.at());
  }

  remove(): void {
    this.away();
  }

  private onDrag(event: PointerEvent): void {
    if (!this.element.hasPointerCapture(event.pointerId) || !event.buttons) return;
    const to = this.page.scene?.pick(...this.page.view.ray(event.clientX, event.clientY));
    if (to) this.grasped.drag(to);
  }

  private onKey(event: KeyboardEvent): void {
    const way = DIRECTIONS[event.key === "=" ? "+" : event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const steps = event.shiftKey && event.key.startsWith("Arrow") ? COARSE : 1;
    this.grasped.nudge(way[0] * steps, way[1] * steps);
  }
}
