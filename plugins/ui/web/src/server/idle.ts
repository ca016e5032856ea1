/** When there is time for what a person does not wait for: the program has its hands full until a surface is felt. */
import type { Hub } from "../hub";

/** After so long with the program there is time anyway: it may have nothing that is felt. */
const PATIENCE_MS = 3000;

/** Kept once a surface is felt, or nothing is being made that would be. */
export function leisure(hub: Hub, patienceMs = PATIENCE_MS): Promise<void> {
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
