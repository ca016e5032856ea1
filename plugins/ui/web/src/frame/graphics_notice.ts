/** Why nothing is drawn, over the place where it would be. */
import "./graphics_notice.css";
import type { Page } from "../page";
import type { Trouble } from "../view/view";
import { t } from "../view/words";

export function notice(page: Page): void {
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
