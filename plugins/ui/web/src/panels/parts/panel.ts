/** Parts: the way into their editor, which comes when it is opened. */
import { button, hint } from "../../elements";
import type { Page } from "../../page";
import type { Panel } from "../panel";
import { t } from "./words";
import { named } from "./guidance";
import "./parts.css";

function build(page: Page, root: HTMLElement): void {
  const told = document.createElement("p");
  told.className = "bad";
  told.setAttribute("role", "status");
  const edit = button(t("edit"), async () => {
    edit.disabled = true;
    told.textContent = "";
    page.say(t("opening"));
    try {
      const { edit: begin } = await import("./editor/editor");
      await begin(page, edit);
    } catch (error) {
      told.textContent = t("failed", { why: (error as Error).message });
    } finally {
      edit.disabled = false;
    }
  });
  edit.id = "parts-edit";
  edit.className = "primary";
  root.append(hint(t("about")), edit, told, named(page));
}

export const parts: Panel = { id: "parts", title: t("title"), place: "left", open: true, build };
