/** Figures for tests and benchmarks, kept only where the address says ?measure: window.figures, window.page. */
import type { Page } from "./page";
import { now } from "./server/protocol";

export const measuring = new URLSearchParams(globalThis.location?.search).has("measure");

export const figures = {
  /** seq, ms from tick to drawn, ms from tick to arrived, when drawn. */
  drawn: [] as number[][],
  /** ms from a pointer that was sent until its force was drawn. */
  trips: [] as number[],
  /** ms that each pick took. */
  picks: [] as number[],
  /** When the surface was drawn first, a law felt first, and each law since; ms of the Unix clock, 0 for not yet. */
  firstMs: 0,
  feltMs: 0,
  touches: [] as number[],
  /** The product that is being made, and when making was last stopped. */
  stage: "",
  /** Whether each frame waits for its pixels, so that `drawn` says when they were there. */
  waits: true,
  stoppedMs: 0,
};

export function measure(page: Page): void {
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
