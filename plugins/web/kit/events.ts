/** The events of the page's hub: the server's messages, and what parts of the page tell one another. */
import type { HandState } from "./hand/state";
import type { Events } from "./server/messages";
import type { State } from "./server/protocol";
import type { Scene } from "./surface/scene";

export interface PageEvents extends Events {
  /** A state arrived. */
  state: State;
  /** A state was drawn. */
  drawn: State;
  /** A surface can be drawn. */
  shown: Scene;
  /** Something about this page's hand changed: its mover, its mode, whether it is the active one. */
  hand: HandState;
  /** The hand is led to a part by its label, or to the middle of the surface (null). */
  led: { label: number | null };
  /** A tour of the parts began or ended. */
  tour: { on: boolean };
  /** Moves of the hand are described, or not. */
  describing: { on: boolean };
  /** A request to colour the surface by the picture, heights, segments ... */
  "look at": { look: string };
  /** The colouring of the surface changed. */
  look: { look: string };
  /** A finer part of the surface on the screen was loaded. */
  finer: Scene;
  /** A recording was opened, a file of this machine. */
  recording: { path: string };
  /** The theme's colours changed (see `colour` in frame/themes.ts). */
  theme: { chosen: string; dark: boolean; contrast: boolean };
  /** Sound was switched on or off. */
  sound: { on: boolean };
  /** Speech was switched, or has another voice ("": none). */
  aloud: { on: boolean; voice: string };
  /** True if a screen reader reads every line of the log. */
  "read log": { on: boolean };
}
