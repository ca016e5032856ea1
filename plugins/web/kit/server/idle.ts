/** Low-priority requests wait until the server is idle: at first it computes the surface. */
import type { Hub } from "../hub";

/** Milliseconds after which the server counts as idle anyway: there may be nothing to compute. */
const PATIENCE_MS = 3000;

/** Return a promise that resolves once a surface can be felt, or none is being computed. */
export function whenIdle(hub: Hub, patienceMs = PATIENCE_MS): Promise<void> {
  return new Promise((begin) => {
    hub.on("touch", () => begin());
    hub.on("made", ({ want, outcome }) => {
      if (want !== "touch" || outcome !== "made") begin();
    });
    hub.on("document", ({ complaints }) => {
      if (complaints.length) begin();
    });
    hub.on("maker_gone", () => begin());
    hub.on("hello", () => void setTimeout(begin, patienceMs));
  });
}
