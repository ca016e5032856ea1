/** Numbered marks over the surface, hidden from screen readers: the panel lists them in words. */
import { make } from "kit/elements";
import type { Page } from "kit/page";
import type { Vec } from "kit/server/protocol";

/** A failing place: shares from the left and from the top. */
export interface Fault {
  number: number;
  at: [number, number];
}

/** Share of the width shown around a place. */
const NEAR = 0.3;

export class FaultMarks {
  private shown = true;
  private away: (() => void)[] = [];
  private elements = new Map<number, HTMLElement>();

  constructor(
    private page: Page,
    /** Returns whether the panel that lists the places is seen: the marks leave with it. */
    private listed: () => boolean,
  ) {}

  set visible(on: boolean) {
    this.shown = on;
    this.page.overlay.changed = true;
  }

  replace(faults: Fault[]): void {
    for (const each of this.away) each();
    this.elements.clear();
    this.away = faults.map(({ number, at }) => {
      const element = make("div", { className: "fault" });
      element.setAttribute("aria-hidden", "true");
      element.append(`${number}`);
      this.elements.set(number, element);
      return this.page.overlay.stay(element, () => (this.shown && this.listed() ? this.where(at) : null));
    });
    this.page.overlay.changed = true;
  }

  /** Highlight a mark; null for none. */
  point(number: number | null): void {
    for (const [each, element] of this.elements) element.classList.toggle("pointed", each === number);
  }

  /** Focus the camera on a place. */
  look(at: [number, number]): void {
    const { scene, view } = this.page;
    const there = this.where(at);
    if (scene && there) view.focus(there, NEAR * scene.meta.extent_m[0]);
  }

  private where([x, y]: [number, number]): Vec | null {
    const { scene } = this.page;
    if (!scene) return null;
    const [w, l] = scene.meta.extent_m;
    return scene.on((x - 0.5) * w, (0.5 - y) * l);
  }
}
