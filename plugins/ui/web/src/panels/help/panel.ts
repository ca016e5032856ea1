/** All keys, from the one table of shortcuts, and the ten main tasks in short. */
import type { Page } from "../../page";
import { reveal, type Panel } from "../panel";
import { on, SHORTCUTS, type Name } from "../../shortcuts";
import { t } from "./words";
import { t as does } from "./shortcut_words";

export const TASKS = ["open", "methods", "make", "feel", "hear", "compare", "devices", "record", "check", "save"] as const;

function build(_: Page, root: HTMLElement): void {
  const heading = (text: string): HTMLElement => Object.assign(document.createElement("h3"), { textContent: text });
  const tasks = document.createElement("ol");
  tasks.className = "tasks";
  tasks.append(...TASKS.map((task) => Object.assign(document.createElement("li"), { textContent: t(task) })));
  root.append(heading(t("keys")), table(), heading(t("tasks")), tasks);
  on("help", () => reveal(help.id));
}

function table(): HTMLTableElement {
  const made = document.createElement("table");
  made.createCaption().textContent = t("caption");
  made.caption!.className = "visually-hidden";
  const head = made.createTHead().insertRow();
  for (const text of [t("key"), t("does")]) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    head.append(cell);
  }
  const body = made.createTBody();
  for (const [name, { keys, where }] of Object.entries(SHORTCUTS)) {
    const row = body.insertRow();
    row.insertCell().append(...keys.flatMap((each) => [caps(each), " "]));
    row.insertCell().textContent = does(name as Name) + (where === "surface" ? ` ${t("onSurface")}` : "");
  }
  return made;
}

/** A key as it is printed on a keyboard. */
export function caps(key: string): HTMLElement {
  const made = document.createElement("kbd");
  made.textContent = key
    .split(/(?<=.)\+/)
    .map((part) => (part in NAMES ? t(NAMES[part]) : part.length === 1 ? part.toUpperCase() : part))
    .join(" + ");
  return made;
}

const NAMES: Record<string, Parameters<typeof t>[0]> = {
  " ": "Space",
  Escape: "Escape",
  Shift: "Shift",
  Ctrl: "Ctrl",
  Alt: "Alt",
  ArrowLeft: "ArrowLeft",
  ArrowRight: "ArrowRight",
  ArrowUp: "ArrowUp",
  ArrowDown: "ArrowDown",
  PageUp: "PageUp",
  PageDown: "PageDown",
  Enter: "Enter",
  Home: "Home",
  End: "End",
};

export const help: Panel = { id: "help", title: t("title"), place: "right", open: false, build };
