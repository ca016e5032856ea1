/** The touch screen: one finger is the hand; two move the camera, and the hand is released until all are up. */
import type { Page } from "../page";
import type { Hand } from "./hand";

/** The fingers on the screen, and whether they move hand or camera. */
export class Fingers {
  private there = new Set<number>();
  private camera = false;

  /** Add a finger; return whether it is the hand. */
  down(id: number): boolean {
    this.there.add(id);
    if (this.there.size > 1) this.camera = true;
    return this.isHand(id);
  }

  up(id: number): void {
    this.there.delete(id);
    if (!this.there.size) this.camera = false;
  }

  isHand(id: number): boolean {
    return !this.camera && this.there.has(id);
  }
}

/** Pressure of fingers, 0 to 1: by force if the browser measures it, else by the size of the contact. */
export class Pressure {
  private forces = new Set<number>();
  private sizes: [number, number] = [Infinity, -Infinity];

  /** Return the pressure; null if unknown: a screen without sensors gives the same at every touch. */
  share({ pressure, width, height }: { pressure: number; width: number; height: number }): number | null {
    if (pressure !== 0 && pressure !== 0.5 && pressure !== 1) this.forces.add(pressure);
    if (this.forces.size >= 3) return pressure;
    const size = (width + height) / 2;
    if (size > 1) this.sizes = [Math.min(this.sizes[0], size), Math.max(this.sizes[1], size)];
    const [least, most] = this.sizes;
    return most > 1.5 * least ? (size - least) / (most - least) : null;
  }
}

export function attachFingers(hand: Hand, page: Pick<Page, "canvas" | "view" | "scene">): void {
  const { canvas, view } = page;
  const fingers = new Fingers();
  const pressure = new Pressure();

  function follow(event: PointerEvent): void {
    const at = page.scene?.pick(...view.ray(event.clientX, event.clientY));
    if (!at) return;
    const share = pressure.share(event);
    if (share !== null) hand.pressShare(share);
    hand.moveOver("touch", at[0], at[1], true);
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType !== "touch") return;
    if (fingers.down(event.pointerId)) follow(event);
    else hand.release("touch");
  });
  canvas.addEventListener("pointermove", (event) => {
    if (event.pointerType === "touch" && fingers.isHand(event.pointerId)) follow(event);
  });
  for (const type of ["pointerup", "pointercancel"] as const)
    canvas.addEventListener(type, (event) => {
      if (event.pointerType !== "touch") return;
      if (fingers.isHand(event.pointerId)) hand.release("touch");
      fingers.up(event.pointerId);
    });
}
