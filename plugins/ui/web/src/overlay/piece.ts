/** A thing that is drawn over the surface, and what it is told in each frame. */
import type { PerspectiveCamera } from "three";
import type { Vec } from "../server/protocol";
import type { Live } from "../contact/reading";
import type { Settings } from "./settings";

/** From where the surface is seen, and how large the canvas is, in CSS pixels. */
export interface Sight {
  readonly camera: PerspectiveCamera;
  width: number;
  height: number;
}

export interface Piece {
  /** Whether it shows less than it was told, as words change only so often: it wants another frame. */
  readonly late?: boolean;
  /** live: null while there is no hand. */
  put(live: Live | null, settings: Settings, sight: Sight): void;
}

/** How much of the workspace one CSS pixel of the canvas shows at a place: pieces keep their size on the screen. */
export function metresPerPixel({ camera, height }: Sight, at: Vec): number {
  const { elements } = camera.matrixWorldInverse;
  const ahead = -(elements[2] * at[0] + elements[6] * at[1] + elements[10] * at[2] + elements[14]);
  return (2 * Math.max(ahead, camera.near) * Math.tan((camera.fov * Math.PI) / 360)) / Math.max(1, height);
}
