/** What all parts of the page share. */
import type { How } from "./speech/announcer";
import type { Hand } from "./hand/hand";
import type { Hub } from "./hub";
import type { Events } from "./server/messages";
import type { Net } from "./server/connection";
import type { Overlay } from "./overlay/overlay";
import type { State } from "./server/protocol";
import type { Scene } from "./surface/scene";
import type { Sound } from "./sound/sound";
import type { Speech } from "./speech/speech";
import type { Themes } from "./frame/themes";
import type { View } from "./view/view";

export interface Page {
  readonly hub: Hub;
  readonly net: Net;
  readonly view: View;
  /** What is drawn over the surface. */
  readonly overlay: Overlay;
  readonly canvas: HTMLCanvasElement;
  /** What is drawn; null before the first. */
  scene: Scene | null;
  /** What moves the device of this page; null before the first moment is over. */
  hand: Hand | null;
  /** The pipeline file on the screen. */
  document: Events["document"] | null;
  /** The tick of a recording that is shown in place of the loop's; null for what is felt now. */
  replayed: State | null;
  readonly sound: Sound;
  readonly speech: Speech;
  readonly themes: Themes;
  /** Kept when there is time to ask for what nobody waits for (server/idle.ts). */
  readonly leisure: Promise<void>;
  /** Say something to who listens, when its turn comes (speech/announcer.ts): in a live region, and aloud where asked for. */
  say(text: string, how?: How): void;
  /** What a topic said no longer holds. */
  forget(topic: string): void;
}
