/** Help: all keys, from the table of shortcuts, and the ten main tasks. */
import { make } from "kit/elements";
import type { Page } from "kit/page";
import { reveal, type Panel } from "../panel";
import { on, SHORTCUTS, type Name } from "kit/shortcuts";
import { caps } from "kit/key_caps";
import { t } from "./words";
import { t as does } from "./shortcut_words";

export const TASKS = ["open", "methods", "make", "feel", "hear", "compare", "devices", "record", "check", "save"] as const;

function build(_: Page, root: HTMLElement): void {
  const heading = (text: string): HTMLElement => make("h3", { textContent: text });
  const tasks = make("ol", { className: "tasks" });
  tasks.append(...TASKS.map((task) => make("li", { textContent: t(task) })));
  root.append(heading(t("keys")), table(), heading(t("tasks")), tasks);
  on("help", () => reveal(help.id));
}

function table(): HTMLTableElement {
  const tableElement = document.createElement("table");
  tableElement.createCaption().textContent = t("caption");
  tableElement.caption!.className = "visually-hidden";
  const head = tableElement.createTHead().insertRow();
  for (const text of [t("key"), t("does")]) {
    const cell = make("th", { scope: "col", textContent: text });
    head.append(cell);
  }
  const body = tableElement.createTBody();
  for (const [name, { keys, where }] of Object.entries(SHORTCUTS)) {
    const row = body.insertRow();
    row.insertCell().append(...keys.flatMap((each) => [caps(each), " "]));
    row.insertCell().textContent = does(name as Name) + (where === "surface" ? ` ${t("onSurface")}` : "");
  }
  return tableElement;
}

export const help: Panel = { id: "help", title: t("title"), task: "any", open: false, build };
