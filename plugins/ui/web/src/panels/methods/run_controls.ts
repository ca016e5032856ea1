/** Buttons to compute depth, texture or everything, to stop, and a note if the surface is outdated. */
import { button, labelled } from "kit/elements";
import type { DocumentEditor } from "../../forms/editor";
import type { Page } from "kit/page";
import { t } from "../../forms/words";

export function runControls(page: Page, editor: DocumentEditor): HTMLElement {
  const box = document.createElement("div");
  const status = document.createElement("p");
  status.setAttribute("role", "status");
  const make = (want: string) => async (): Promise<void> => {
    status.textContent = "";
    try {
      await page.net.ask("make", { want });
    } catch (error) {
      status.textContent = (error as Error).message;
      status.className = "bad";
    }
  };
  const all = button(t("make"), make("touch"), { id: "make", className: "primary" });
  const stop = button(t("stopMaking"), () => page.net.ask("stop_making"), { id: "stop-making" });
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(all, button(t("runDepth"), make("relief")), button(t("runTexture"), make("materials")), stop);
  const again = button(t("tryAgain"), () => page.net.ask("try_again"), { hidden: true });
  box.append(buttons, atOnce(editor), status, again);

  let busy = false;
  let text = "";
  const show = (): void => {
    stop.setAttribute("aria-disabled", String(!busy));
    const pending = !busy && text !== "" && page.document !== null && page.document.digest !== text;
    all.classList.toggle("pending", pending);
    if (pending || status.textContent === t("pending")) status.textContent = pending ? t("pending") : "";
    if (pending) status.className = "warn";
  };
  page.hub.on("making", () => {
    busy = true;
    status.textContent = "";
    show();
  });
  page.hub.on("made", ({ want, outcome, digest }) => {
    busy = false;
    if (outcome === "made" && want === "touch") text = digest;
    show();
  });
  page.hub.on("document", show);
  page.hub.on("gone", () => {
    busy = false;
    show();
  });
  page.hub.on("maker_gone", ({ why }) => {
    status.textContent = t("makerGone", { why });
    status.className = "bad";
    again.hidden = false;
  });
  page.hub.on("maker", () => (again.hidden = true));
  show();
  return box;
}

function atOnce(editor: DocumentEditor): HTMLElement {
  const input = document.createElement("input");
  input.type = "checkbox";
  input.id = "apply-at-once";
  input.checked = editor.apply;
  input.onchange = () => (editor.apply = input.checked);
  return labelled(input, t("atOnce"));
}
