/** Run depth, texture or all of it; stop; and whether what is felt is what the document says. */
import { button } from "../../elements";
import type { Editor } from "../../forms/editor";
import type { Page } from "../../page";
import { t } from "../../forms/words";

export function running(page: Page, editor: Editor): HTMLElement {
  const box = document.createElement("div");
  const told = document.createElement("p");
  told.setAttribute("role", "status");
  const make = (want: string) => async (): Promise<void> => {
    told.textContent = "";
    try {
      await page.net.ask("make", { want });
    } catch (error) {
      told.textContent = (error as Error).message;
      told.className = "bad";
    }
  };
  const all = button(t("make"), make("touch"));
  all.id = "make";
  all.className = "primary";
  const stop = button(t("stopMaking"), () => page.net.ask("stop_making"));
  stop.id = "stop-making";
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(all, button(t("runDepth"), make("relief")), button(t("runTexture"), make("materials")), stop);
  const again = button(t("tryAgain"), () => page.net.ask("try_again"));
  again.hidden = true;
  box.append(buttons, atOnce(editor), told, again);

  let busy = false;
  let made = "";
  const show = (): void => {
    stop.setAttribute("aria-disabled", String(!busy));
    const pending = !busy && made !== "" && page.document !== null && page.document.digest !== made;
    all.classList.toggle("pending", pending);
    if (pending || told.textContent === t("pending")) told.textContent = pending ? t("pending") : "";
    if (pending) told.className = "warn";
  };
  page.hub.on("making", () => {
    busy = true;
    told.textContent = "";
    show();
  });
  page.hub.on("made", ({ want, outcome, digest }) => {
    busy = false;
    if (outcome === "made" && want === "touch") made = digest;
    show();
  });
  page.hub.on("document", show);
  page.hub.on("gone", () => {
    busy = false;
    show();
  });
  page.hub.on("maker_gone", ({ why }) => {
    told.textContent = t("makerGone", { why });
    told.className = "bad";
    again.hidden = false;
  });
  page.hub.on("maker", () => (again.hidden = true));
  show();
  return box;
}

function atOnce(editor: Editor): HTMLElement {
  const label = document.createElement("label");
  const input = document.createElement("input");
  input.type = "checkbox";
  input.id = "apply-at-once";
  input.checked = editor.apply;
  input.onchange = () => (editor.apply = input.checked);
  label.append(input, t("atOnce"));
  return label;
}
