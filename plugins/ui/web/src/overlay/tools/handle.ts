/** A handle on the surface: a button that is dragged with the pointer, or moved with the arrow keys. */
import type { Page } from "../../page";
import type { Vec } from "../../server/protocol";

export const STEP_M = 0.0005;
export const COARSE = 10;
const WAYS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
  "-": [-1, -1],
  "+": [1, 1],
};

export interface Grasped {
  /** Where it is; null while it is not shown. */
  at(): Vec | null;
  /** The pointer has dragged it to a place on the surface. */
  drag(to: Vec): void;
  /** Steps by the keys, right and away from the user; Shift makes ten of one. */
  nudge(right: number, away: number): void;
  /** It was let go, or the key was. */
  done?(): void;
}

export class Handle {
  readonly element = document.createElement("button");
  private away: () => void;

  constructor(
    private page: Page,
    shape: "round" | "square" | "turn" | "move",
    label: string,
    private grasped: Grasped,
  ) {
    this.element.type = "button";
    this.element.className = `handle ${shape}`;
    this.element.setAttribute("aria-label", label);
    this.element.title = label;
    this.element.onpointerdown = (event) => this.element.setPointerCapture(event.pointerId);
    this.element.onpointermove = (event) => this.dragged(event);
    this.element.onlostpointercapture = () => grasped.done?.();
    this.element.onkeydown = (event) => this.pressed(event);
    this.element.onkeyup = (event) => {
      if (WAYS[event.key]) grasped.done?.();
    };
    this.away = page.overlay.stay(this.element, () => grasped.at());
  }

  remove(): void {
    this.away();
  }

  private dragged(event: PointerEvent): void {
    if (!this.element.hasPointerCapture(event.pointerId) || !event.buttons) return;
    const to = this.page.scene?.pick(...this.page.view.ray(event.clientX, event.clientY));
    if (to) this.grasped.drag(to);
  }

  private pressed(event: KeyboardEvent): void {
    const way = WAYS[event.key === "=" ? "+" : event.key];
    if (!way || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const steps = event.shiftKey && event.key.startsWith("Arrow") ? COARSE : 1;
    this.grasped.nudge(way[0] * steps, way[1] * steps);
  }
}
