/** Beside the cursor: the force in newtons, whether the contact sticks or slips, and what the guard limits. */
import type { View } from "../../view/view";
import { t } from "../words";
import { tip } from "./force_arrow";
import { LIMITS, limited } from "../../contact/limits";
import type { Live } from "../../contact/reading";
import type { Piece, Sight } from "../piece";
import type { Settings } from "../settings";

/** Words change at most so often, so that they can be read. */
const EVERY_MS = 100;
/** A limit that was seen is named for so long. */
const KEPT_MS = 600;
const OFF_PX = 14;
/** Shapes that go with the words. */
export const GLYPHS = { apart: "", rests: "●", sticks: "■", slips: "»", glides: "○" } as const;

export class Labels implements Piece {
  late = false;
  private box = document.createElement("div");
  private force = line(this.box, "force");
  private other = line(this.box, "other");
  private grip = line(this.box, "grip");
  private limits = line(this.box, "limits");
  private readMs = 0;
  private seenMs = new Map<number, number>();
  private wide = 0;
  private high = 0;

  constructor(
    layer: HTMLElement,
    private view: View,
  ) {
    this.box.className = "live-label";
    this.box.setAttribute("aria-hidden", "true"); // the same is said in words elsewhere
    layer.append(this.box);
  }

  put(live: Live | null, settings: Settings, sight: Sight): void {
    const { show } = settings;
    const hidden = !live || (!live.touching && live.otherN === 0 && !limited(live.state.flags)) || !(show.labels || show.limits);
    if (this.box.hidden !== hidden) this.box.hidden = hidden;
    this.late = false;
    if (!live || hidden) return;
    this.words(live, settings);
    this.place(live, settings, sight);
  }

  private words(live: Live, { show }: Settings): void {
    const now = performance.now();
    for (const { bit } of LIMITS) if (live.state.flags & bit) this.seenMs.set(bit, now);
    this.late = now - this.readMs < EVERY_MS;
    if (this.late) return;
    this.readMs = now;
    say(this.force, show.labels ? `${live.newtons.toFixed(2)} N` : "");
    say(this.other, show.labels && live.otherN > 0 ? t("otherForce", { newtons: live.otherN.toFixed(2) }) : "");
    say(this.grip, show.labels && live.grip !== "apart" ? `${GLYPHS[live.grip]} ${t(live.grip)}` : "");
    const held = LIMITS.filter(({ bit }) => now - (this.seenMs.get(bit) ?? -Infinity) < KEPT_MS);
    say(this.limits, show.limits ? held.map(({ word }) => `⚠ ${t(word)}`).join("\n") : "");
    this.wide = this.box.offsetWidth;
    this.high = this.box.offsetHeight;
  }

  /** Beside the arrow's end, and whole within the canvas. */
  private place(live: Live, { metresPerNewton }: Settings, { width, height }: Sight): void {
    const [x, y] = this.view.toScreen(tip(live, live.state.force, metresPerNewton));
    const left = x + OFF_PX + this.wide > width ? x - OFF_PX - this.wide : x + OFF_PX;
    const [u, v] = [within(left, width - this.wide), within(y - this.high / 2, height - this.high)];
    this.box.style.transform = `translate(${u.toFixed(0)}px, ${v.toFixed(0)}px)`;
  }
}

const within = (at: number, most: number): number => Math.max(0, Math.min(at, most));

function line(box: HTMLElement, name: string): HTMLElement {
  const made = document.createElement("div");
  made.className = name;
  box.append(made);
  return made;
}

function say(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
