/** What is shown of the surface on the screen: the chosen look where there is one such, and changes of it. */
import type { Meta } from "../server/messages";
import type { Page } from "../page";
import { fetchLayer, type Layer } from "../surface/loading";
import { remember, remembered, type Settings } from "./settings";

/** The looks that a surface has, in the order in which they are offered. */
export function looksOf(meta: Meta): string[] {
  return [
    ...(meta.photo ? ["photo"] : []),
    "relief",
    "height",
    "slope",
    ...(meta.materials.length ? ["materials"] : []),
    ...(meta.labels ? ["segments"] : []),
    ...Object.keys(meta.layers),
  ];
}

/** What is shown at first: what was asked to be made, then what was chosen, then what there is. */
export function lookFor(meta: Meta, chosen: string): string {
  const there = looksOf(meta);
  if (meta.shows === "segments" && there.includes("segments")) return "segments";
  return there.includes(chosen) ? chosen : there[0];
}

export class Showing {
  readonly settings: Settings = remembered();
  /** What is shown now; the chosen one is `settings.look`. */
  look = this.settings.look;
  layer: Layer | null = null;
  /** Called when another look is shown, or another surface. */
  changed: () => void = () => {};

  constructor(private page: Page) {
    this.page.view.eyeDome = this.settings.eyeDome;
  }

  /** Draw the page's surface, which is another one than before. */
  begin(): void {
    const { scene, view } = this.page;
    if (!scene) return;
    this.layer = null;
    this.look = lookFor(scene.meta, this.settings.look);
    view.put(scene, { ...this.settings, look: this.look in scene.meta.layers ? "relief" : this.look });
    void this.draw();
  }

  set(changes: Partial<Settings>): void {
    Object.assign(this.settings, changes);
    remember(this.settings);
    if (changes.look) this.look = changes.look;
    void this.draw();
  }

  private async draw(): Promise<void> {
    const { scene, view, hub } = this.page;
    const { look } = this;
    if (scene && look in scene.meta.layers) {
      try {
        this.layer = await fetchLayer(scene, look);
      } catch (error) {
        hub.tell("error", { event: "error", at_s: Date.now() / 1000, text: (error as Error).message });
        return;
      }
      if (scene !== this.page.scene || look !== this.look) return;
    } else this.layer = null;
    view.eyeDome = this.settings.eyeDome;
    view.terrain?.show({ ...this.settings, look }, this.layer);
    view.dirty = true;
    hub.tell("look", { look });
    this.changed();
  }
}
