/** Figures for tests and benchmarks, recorded only if the address has ?measure: window.figures, window.page. */
import type { Page } from "./page";
import { now } from "./server/protocol";

export const measuring = new URLSearchParams(globalThis.location?.search).has("measure");

export const figures = {
  /** State number, ms from tick to drawn, ms from tick to arrived, time drawn. */
  drawn: [] as number[][],
  /** Milliseconds from sending a pointer until its force is drawn. */
  trips: [] as number[],
  /** Duration of each pick, ms. */
  picks: [] as number[],
  /** Time of the first drawing, of the first touch, and of each touch since; ms of the Unix clock, 0 for not yet. */
  firstMs: 0,
  feltMs: 0,
  touches: [] as number[],
  /** The product being computed, and when computing was last stopped. */
  stage: "",
  /** True if each frame waits for its pixels, so that `drawn` holds when they were visible. */
  waits: true,
  stoppedMs: 0,
};

export function measure(page: Pick<Page, "hub">): void {
  if (!measuring) return;
  document.body.classList.add("measure");
  Object.assign(window, { figures, page });
  page.hub.on("touch", () => {
    figures.touches.push(now());
    figures.feltMs ||= now();
  });
  page.hub.on("stage", ({ product, done }) => (figures.stage = done.outcome ? "" : product));
  page.hub.on("made", ({ outcome }) => {
    if (outcome === "stopped") figures.stoppedMs = now();
  });
}
