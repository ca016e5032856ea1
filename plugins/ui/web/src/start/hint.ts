/** One line on the canvas that says how to feel; it goes once somebody has felt. */
import type { Page } from "kit/page";
import { isTouching } from "kit/server/protocol";
import "./hint.css";
import { t } from "./words";

export function showHint(page: Pick<Page, "hub" | "view">): void {
  const line = Object.assign(document.createElement("p"), { id: "how-to-feel", hidden: true });
  line.textContent = t(matchMedia("(hover: none)").matches ? "feelByFinger" : "feelByMouse");
  document.getElementById("scenery")!.append(line);
  page.view.keepFree(line, "top");
  let felt = false;
  let ours = false;
  const show = (): void => void (line.hidden = felt || !ours || !page.hub.last("shown"));
  page.hub.on("shown", show);
  page.hub.on("loop", ({ running, own_hand }) => {
    ours = running && own_hand !== false;
    show();
  });
  page.hub.on("state", (state) => {
    if (felt || !isTouching(state)) return;
    felt = true;
    show();
  });
}
