/** Label next to the cursor: force in newtons, whether the contact sticks or slips, active limits. */
import { notation } from "../../words/words";
import type { View } from "../../view/view";
import { t } from "../words";
import { tip } from "./force_arrow";
import { LIMITS, isLimited } from "../../contact/limits";
import type { Reading } from "../../contact/reading";
import type { Piece, Sight } from "../piece";
import type { Settings } from "../settings";

/** Shortest time between changes of the text, for legibility. */
const EVERY_MS = 100;
/** Time for which a limit stays named. */
const KEPT_MS = 600;
const OFF_PX = 14;
/** Symbols next to the words. */
export const GLYPHS = { apart: "", rests: "●", sticks: "■", slips: "»", glides: "○" } as const;

export class ContactLabel implements Piece {
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
    this.box.setAttribute("aria-hidden", "true"); // screen readers get the same elsewhere
    layer.append(this.box);
  }

  put(live: Reading | null, settings: Settings, sight: Sight): void {
    const { show } = settings;
    const hidden = !live || (!live.touching && live.otherN === 0 && !isLimited(live.state.flags)) || !(show.labels || show.limits);
    if (this.box.hidden !== hidden) this.box.hidden = hidden;
    this.late = false;
    if (!live || hidden) return;
    this.words(live, settings);
    this.place(live, settings, sight);
  }

  private words(live: Reading, { show }: Settings): void {
    const now = performance.now();
    for (const { bit } of LIMITS) if (live.state.flags & bit) this.seenMs.set(bit, now);
    this.late = now - this.readMs < EVERY_MS;
    if (this.late) return;
    this.readMs = now;
    say(this.force, show.labels ? `${notation(live.newtons.toFixed(2))} N` : "");
    say(this.other, show.labels && live.otherN > 0 ? t("otherForce", { newtons: live.otherN.toFixed(2) }) : "");
    say(this.grip, show.labels && live.grip !== "apart" ? `${GLYPHS[live.grip]} ${t(live.grip)}` : "");
    const held = LIMITS.filter(({ bit }) => now - (this.seenMs.get(bit) ?? -Infinity) < KEPT_MS);
    say(this.limits, show.limits ? held.map(({ word }) => `⚠ ${t(word)}`).join("\n") : "");
    this.wide = this.box.offsetWidth;
    this.high = this.box.offsetHeight;
  }

  /** Place the label next to the arrow's end, within the canvas. */
  private place(live: Reading, { metresPerNewton }: Settings, { width, height }: Sight): void {
    const [x, y] = this.view.toScreen(tip(live, live.state.force, metresPerNewton));
    const left = x + OFF_PX + this.wide > width ? x - OFF_PX - this.wide : x + OFF_PX;
    const [u, v] = [within(left, width - this.wide), within(y - this.high / 2, height - this.high)];
    this.box.style.transform = `translate(${u.toFixed(0)}px, ${v.toFixed(0)}px)`;
  }
}

const within = (at: number, most: number): number => Math.max(0, Math.min(at, most));

function line(box: HTMLElement, name: string): HTMLElement {
  const results = document.createElement("div");
  results.className = name;
  box.append(results);
  return results;
}

function say(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
