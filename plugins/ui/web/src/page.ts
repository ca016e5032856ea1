/** What all parts of the page share. */
import type { Hub } from "./hub";
import type { Events } from "./messages";
import type { Net } from "./net";
import type { Overlay } from "./overlay/overlay";
import type { State } from "./protocol";
import type { Scene } from "./scene";
import type { View } from "./view";

export interface Page {
  readonly hub: Hub;
  readonly net: Net;
  readonly view: View;
  /** What is drawn over the surface. */
  readonly overlay: Overlay;
  readonly canvas: HTMLCanvasElement;
  /** What is drawn; null before the first. */
  scene: Scene | null;
  /** The pipeline file on the screen. */
  document: Events["document"] | null;
  /** The tick of a recording that is shown in place of the loop's; null for what is felt now. */
  replayed: State | null;
  /** Say something to who listens: in the live region, and aloud where that is asked for. */
  say(text: string): void;
}
