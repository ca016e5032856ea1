/** Tools that take the mouse from the hand: its main button then means places on the surface. */
import type { PointerTool } from "../page";
import type { Vec } from "../server/protocol";
import type { Scene } from "../surface/scene";
import type { View } from "../view/view";

/** The holder of the pointer: one tool at a time. */
export class Picking {
  private tool: PointerTool | null = null;
  private last: Vec | null = null;

  constructor(
    private view: View,
    private canvas: HTMLCanvasElement,
    private scene: () => Scene | null,
  ) {
    const around = canvas.parentElement!;
    for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"] as const)
      around.addEventListener(type, (event) => this.hear(event), { capture: true });
  }

  get busy(): PointerTool | null {
    return this.tool;
  }

  take(tool: PointerTool | null): void {
    const before = this.tool;
    this.tool = tool;
    this.last = null;
    this.canvas.classList.toggle("picking", tool !== null);
    if (before !== tool) before?.left?.();
  }

  private hear(event: PointerEvent): void {
    if (!this.tool || event.target !== this.canvas || event.altKey || (event.buttons & ~1) !== 0) return;
    if (event.type === "pointerdown" && event.button !== 0) return;
    event.stopImmediatePropagation();
    const at = this.scene()?.pick(...this.view.ray(event.clientX, event.clientY)) ?? null;
    if (event.type === "pointerdown") {
      this.canvas.setPointerCapture(event.pointerId);
      this.canvas.focus();
      this.last = at;
      if (at) this.tool.begin(at);
    } else if (event.type === "pointermove") {
      if (at && this.last && event.buttons & 1) this.tool.drag?.((this.last = at));
    } else if (this.last) {
      const end = this.last;
      this.last = null;
      this.tool.end?.(end);
    }
  }
}
