/** Scale bar at the lower left: length of a newton and of the picture at the cursor. */
import type { View } from "../../view/view";
import { t } from "../words";
import { metresPerPixel, type Piece, type Sight } from "../piece";
import type { Reading } from "../../contact/reading";
import { roundDown125, type Settings } from "../settings";

const MAX_PX = 130;
const EVERY_MS = 100;

export class ScaleBar implements Piece {
  late = false;
  private box = document.createElement("div");
  private bar = document.createElement("span");
  private words = document.createElement("span");
  private readMs = 0;

  constructor(
    layer: HTMLElement,
    private view: View,
  ) {
    this.box.className = "scale-bar";
    this.box.append(this.bar, this.words);
    layer.append(this.box);
    view.keepFree(this.box, "bottom");
  }

  put(live: Reading | null, { show, metresPerNewton }: Settings, sight: Sight): void {
    this.box.classList.toggle("unseen", !show.arrow); // its room stays, so that the surface does not move
    const now = performance.now();
    this.late = show.arrow && now - this.readMs < EVERY_MS;
    if (!show.arrow || this.late) return;
    this.readMs = now;
    const pixel = metresPerPixel(sight, live?.contact ?? this.view.eye.pose.target);
    const newtons = roundDown125((MAX_PX * pixel) / metresPerNewton);
    const metres = newtons * metresPerNewton;
    this.bar.style.width = `${(metres / pixel).toFixed(1)}px`;
    const text = t("scale", { newtons, mm: Number((1000 * metres).toPrecision(3)) });
    if (this.words.textContent !== text) this.words.textContent = text;
  }
}
