/** A piece of the overlay, and its input in each frame. */
import type { PerspectiveCamera } from "three";
import type { Vec } from "../server/protocol";
import type { Reading } from "../contact/reading";
import type { Settings } from "./settings";

/** The camera, and the size of the canvas in CSS pixels. */
export interface Sight {
  readonly camera: PerspectiveCamera;
  width: number;
  height: number;
}

export interface Piece {
  /** True if the piece is not up to date, as texts change only so often: another frame is needed. */
  readonly late?: boolean;
  /** Move to this reading; null while there is no hand. */
  put(live: Reading | null, settings: Settings, sight: Sight): void;
}

/** Return metres per CSS pixel at a place: pieces keep their size on the screen. */
export function metresPerPixel({ camera, height }: Sight, at: Vec): number {
  const { elements } = camera.matrixWorldInverse;
  const ahead = -(elements[2] * at[0] + elements[6] * at[1] + elements[10] * at[2] + elements[14]);
  return (2 * Math.max(ahead, camera.near) * Math.tan((camera.fov * Math.PI) / 360)) / Math.max(1, height);
}
