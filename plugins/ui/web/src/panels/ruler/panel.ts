/** The ruler and the markers: figures, a profile, and the keyboard's way to both. */
import "../overlay/overlay.css";
import { button, make } from "kit/elements";
import { Markers } from "kit/overlay/tools/markers";
import type { Measurement } from "kit/overlay/tools/measurement";
import { profile } from "kit/overlay/tools/profile";
import { Ruler } from "kit/overlay/tools/ruler";
import { formatFixed } from "kit/contact/values";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "kit/overlay/words";

function build(page: Page, root: HTMLElement): void {
  const ruler = new Ruler(page);
  const mouse = button(t("rulerMouse"), () => ruler.toggle());
  const here = button(t("rulerHere"), () => ruler.addHere());
  const remove = button(t("rulerRemove"), () => ruler.remove());
  const help = make("small", { textContent: t("rulerHelp") });
  const buttons = make("div", { className: "buttons" });
  buttons.append(mouse, here, remove);
  const results = document.createElement("div");
  root.append(buttons, help, results, markers(page));
  ruler.onChange = () => {
    mouse.setAttribute("aria-pressed", `${ruler.picking}`);
    remove.disabled = ruler.ends.length === 0;
    results.replaceChildren(...(ruler.measured ? [figures(ruler.measured), profile(ruler.measured)] : []));
  };
  ruler.onChange();
}

function figures(measured: Measurement): HTMLElement {
  const list = make("dl", { className: "ruler-figures" });
  const mm = (metres: number): string => `${formatFixed(1000 * metres, 2)} mm`;
  const degrees = (measured.slope * 180) / Math.PI;
  const steep = Math.abs(degrees) > 89.99 ? "" : ` (${formatFixed(100 * Math.tan(measured.slope), 0)} %)`;
  const rows: [string, string][] = [
    [t("straight"), mm(measured.straightM)],
    [t("horizontal"), mm(measured.horizontalM)],
    [t("surface"), mm(measured.surfaceM)],
    [t("rise"), mm(measured.riseM)],
    [t("slope"), `${formatFixed(degrees, 1)}°${steep}`],
  ];
  for (const [name, value] of rows) {
    const [term, says] = [document.createElement("dt"), document.createElement("dd")];
    term.textContent = name;
    says.textContent = value;
    list.append(term, says);
  }
  return list;
}

function markers(page: Page): HTMLElement {
  const all = new Markers(page);
  const box = document.createElement("section");
  const heading = make("h3", { textContent: t("markersTitle") });
  const list = make("ul", { className: "marker-list" });
  box.append(heading, button(t("markHere"), () => all.addHere()), list);
  all.onChange = () => {
    const lines = all.list.map((marker) => {
      const line = document.createElement("li");
      const [x, y, z] = marker.at.map((part) => (1000 * part).toFixed(1));
      const away = button("×", () => marker.remove());
      away.setAttribute("aria-label", t("removeMarker", { number: marker.number }));
      line.append(t("markerAt", { number: marker.number, x, y, z }), away);
      return line;
    });
    list.replaceChildren(...lines);
  };
  return box;
}

export const ruler: Panel = { id: "ruler-panel", title: t("ruler"), task: "advanced", open: false, build };
