/** The methods of the document, as forms; run and stop. */
import { StageForm } from "../form";
import type { Page } from "../page";
import type { Panel } from "../panel";
import { t } from "../words/methods";

function build(page: Page, root: HTMLElement): void {
  const make = document.createElement("button");
  make.textContent = t("make");
  make.onclick = () => void page.net.ask("make");
  const stop = document.createElement("button");
  stop.textContent = t("stopMaking");
  stop.onclick = () => void page.net.ask("stop_making");
  const forms = document.createElement("div");
  root.append(make, stop, forms);
  void StageForm;
}

export const methods: Panel = { id: "methods", title: t("title"), place: "left", open: true, build };
