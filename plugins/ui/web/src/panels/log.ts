/** The log: what happened, with filters. */
import type { Page } from "../page";
import type { Panel } from "../panel";
import { t } from "../words/log";

function build(page: Page, root: HTMLElement): void {
  const list = document.createElement("ol");
  list.id = "log";
  list.tabIndex = 0;
  list.setAttribute("aria-label", t("lines"));
  root.append(list);
  const add = (level: string, at_s: number, text: string): void => {
    const line = document.createElement("li");
    line.dataset.level = level;
    line.textContent = `${new Date(1000 * at_s).toLocaleTimeString()} ${text}`;
    list.append(line);
    list.scrollTop = list.scrollHeight;
  };
  page.hub.on("stage", ({ at_s, product, method, done }) => {
    if (done.outcome) add(done.outcome === "failed" ? "error" : "event", at_s, `${product} ${done.outcome} ${method} ${done.seconds!.toFixed(3)} s: ${done.why}`);
  });
  page.hub.on("touch", ({ at_s, law, how }) => add("event", at_s, `${law}: ${how}`));
  page.hub.on("error", ({ at_s, text }) => add("error", at_s, text));
}

export const log: Panel = { id: "log-panel", title: t("title"), place: "bottom", open: true, build };
