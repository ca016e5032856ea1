/** Mapping of the picture to the hand: a frame to drag, and a region to enlarge. */
import "../overlay/overlay.css";
import { button, labelled, make } from "kit/elements";
import { MappingFrame } from "kit/overlay/tools/mapping_frame";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "kit/overlay/words";

function build(page: Page, root: HTMLElement): void {
  const frame = new MappingFrame(page);
  const show = make("input", { type: "checkbox" });
  show.onchange = () => frame.show(show.checked);
  const label = labelled(show, t("frameShow"));
  const says = document.createElement("p");
  const help = make("small", { textContent: t("frameHelp") });
  const buttons = make("div", { className: "buttons" });
  const region = button(t("zoomRegion"), () => frame.toggleRegion());
  buttons.append(region, button(t("zoomHere"), () => frame.zoomHere()), button(t("whole"), () => frame.whole()));
  root.append(label, says, help, buttons);
  frame.onChange = () => {
    region.setAttribute("aria-pressed", `${frame.picking}`);
    help.hidden = !frame.shown;
    says.textContent = words(frame);
  };
  frame.onChange();
}

function words(frame: MappingFrame): string {
  const now = frame.reach;
  if (!now) return "";
  const [width, length] = now.size.map((side) => (1000 * side).toFixed(1));
  return frame.isBounded
    ? t("reaches", { device: frame.device, width, length, degrees: now.turnDeg.toFixed(0) })
    : t("reachesAll", { width, length });
}

export const mapping: Panel = { id: "mapping-panel", title: t("mapping"), task: "advanced", open: false, build };
