/** The touch screen: one finger is the hand, where it is; two are the camera's, and the hand is gone until all are up. */
import type { Hand } from "./hand";

/** Which fingers are there, and whose they are. */
export class Fingers {
  private there = new Set<number>();
  private camera = false;

  /** Whether the finger that came is the hand. */
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

/** How hard fingers press, 0 to 1, where the browser says so: by force, else by the size of the contact. */
export class Pressure {
  private forces = new Set<number>();
  private sizes: [number, number] = [Infinity, -Infinity];

  /** Null where it says nothing: a screen without either gives the same at every touch. */
  share({ pressure, width, height }: { pressure: number; width: number; height: number }): number | null {
    if (pressure !== 0 && pressure !== 0.5 && pressure !== 1) this.forces.add(pressure);
    if (this.forces.size >= 3) return pressure;
    const size = (width + height) / 2;
    if (size > 1) this.sizes = [Math.min(this.sizes[0], size), Math.max(this.sizes[1], size)];
    const [least, most] = this.sizes;
    return most > 1.5 * least ? (size - least) / (most - least) : null;
  }
}

export function touch(hand: Hand): void {
  const { canvas, view } = hand.page;
  const fingers = new Fingers();
  const pressure = new Pressure();

  function follow(event: PointerEvent): void {
    const at = hand.page.scene?.pick(...view.ray(event.clientX, event.clientY));
    if (!at) return;
    const share = pressure.share(event);
    if (share !== null) hand.pressShare(share);
    hand.over("touch", at[0], at[1], true);
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
