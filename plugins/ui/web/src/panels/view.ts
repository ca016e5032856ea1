/** How the surface is drawn. */
import type { Page } from "../page";
import type { Panel } from "../panel";
import { LOOKS, type Look } from "../terrain";
import { t } from "../words/view";

function build(page: Page, root: HTMLElement): void {
  const box = document.createElement("fieldset");
  const legend = document.createElement("legend");
  legend.textContent = t("shows");
  box.append(legend);
  for (const look of LOOKS) box.append(radio(look, () => page.view.terrain?.look(look)));
  root.append(box);

  function radio(look: Look, chosen: () => void): HTMLElement {
    const label = document.createElement("label");
    const input = document.createElement("input");
    input.type = "radio";
    input.name = "look";
    input.value = look;
    input.checked = look === "photo";
    input.onchange = () => {
      chosen();
      page.view.dirty = true;
    };
    label.append(input, t(look));
    return label;
  }
}

export const view: Panel = { id: "view", title: t("title"), place: "right", open: true, build };
