/** The parts panel: opens the editor, whose module is loaded then. */
import { button, hint, make } from "kit/elements";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "./words";
import { namedParts } from "./guidance";
import "./parts.css";

function build(page: Page, root: HTMLElement): void {
  const status = make("p", { className: "bad" });
  status.setAttribute("role", "status");
  const edit = button(t("edit"), async () => {
    edit.disabled = true;
    status.textContent = "";
    page.say(t("opening"));
    try {
      const { edit: begin } = await import("./editor/editor");
      await begin(page, edit);
    } catch (error) {
      status.textContent = t("failed", { why: (error as Error).message });
    } finally {
      edit.disabled = false;
    }
  });
  edit.id = "parts-edit";
  edit.className = "primary";
  root.append(hint(t("about")), edit, status, namedParts(page));
}

export const parts: Panel = { id: "parts", title: t("title"), task: "parts", open: true, build };
