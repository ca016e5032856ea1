/** A notice over the canvas that says why nothing is drawn. */
import "./graphics_notice.css";
import type { Page } from "kit/page";
import type { Trouble } from "kit/view/view";
import { t } from "kit/view/words";

export function showGraphicsTrouble(page: Pick<Page, "view" | "canvas">): void {
  const box = document.createElement("p");
  box.id = "no-terrain";
  box.setAttribute("role", "alert");
  page.canvas.after(box);
  const say = (trouble: Trouble): void => {
    box.hidden = !trouble;
    box.textContent = trouble && t(trouble);
  };
  page.view.troubled = say;
  say(page.view.trouble);
}
