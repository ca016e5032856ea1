/** The look of the surface on the screen: the chosen one if the surface has it. */
import type { Meta } from "../server/messages";
import type { Page } from "../page";
import { fetchLayer, type Layer } from "../surface/loading";
import { rememberSettings, recallSettings, type Settings } from "./settings";

/** Return the looks of a surface, in order. */
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

/** Return the first look: the computed product's, then the chosen one, then the first available. */
export function lookFor(meta: Meta, chosen: string): string {
  const there = looksOf(meta);
  if (meta.shows === "segments" && there.includes("segments")) return "segments";
  return there.includes(chosen) ? chosen : there[0];
}

export class Look {
  readonly settings: Settings = recallSettings();
  /** The present look; the chosen one is `settings.look`. */
  look = this.settings.look;
  layer: Layer | null = null;
  /** Called when look or surface changed. */
  onChange: () => void = () => {};

  constructor(private page: Pick<Page, "hub" | "view" | "scene">) {
    this.page.view.eyeDome = this.settings.eyeDome;
  }

  /** Draw the page's new surface. */
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
    rememberSettings(this.settings);
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
    this.onChange();
  }
}
