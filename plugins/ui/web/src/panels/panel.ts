/** A panel of the page: an independent section under a heading. */
import { make } from "kit/elements";
import type { Page } from "kit/page";
import { bring, holder, type Place } from "../frame/tasks";
import { recall, remember } from "kit/preferences";
import { t } from "./words";

export interface Panel {
  id: string;
  title: string;
  /** The task that it serves: "picture", "parts", "feel" or "hand-on"; "advanced" for settings; "any" below every task. */
  task: Place;
  /** True if it is open at first. */
  open: boolean;
  /** Build the contents, once, open or not. Headings in `root` are <h3>; classes for controls are listed in style/tokens.css. */
  build(page: Page, root: HTMLElement): void | Promise<void>;
}

const WAYS: Record<string, (all: HTMLElement[], at: number) => HTMLElement | undefined> = {
  ArrowDown: (all, at) => all[at + 1],
  ArrowUp: (all, at) => all[at - 1],
  Home: (all) => all[0],
  End: (all) => all.at(-1),
};

/** Add panels to their tasks, each under a heading that opens and closes it. A panel that fails leaves the others. */
export function build(page: Page, panels: Panel[]): void {
  for (const panel of panels) {
    const root = place(panel);
    try {
      void panel.build(page, root);
    } catch (error) {
      root.textContent = t("failed", { error: String(error) });
      root.classList.add("bad");
      console.error(error);
    }
  }
}

/** Bring a panel to the screen, open it and focus its heading. */
export function reveal(id: string): void {
  const box = document.getElementById(id) as HTMLDetailsElement;
  bring(box);
  box.open = true;
  box.querySelector("summary")!.focus();
  box.scrollIntoView({ block: "nearest" });
}

function place(panel: Panel): HTMLElement {
  const box = make("details", { id: panel.id, className: "panel", open: recall(`panel.${panel.id}`, panel.open) });
  box.addEventListener("toggle", () => remember(`panel.${panel.id}`, box.open));
  const heading = document.createElement("summary");
  const title = document.createElement("h2");
  title.textContent = panel.title;
  heading.append(title);
  heading.addEventListener("keydown", walk);
  heading.addEventListener("click", () => remember(`panel.${panel.id}`, !box.open)); // "toggle" may come after a reload
  const root = make("div", { className: "inside" });
  box.append(heading, root);
  holder(panel.task).append(box);
  return root;
}

/** Move the focus between the headings of a region that are shown, by arrow keys. */
function walk(event: KeyboardEvent): void {
  const way = WAYS[event.key];
  if (!way) return;
  const here = event.currentTarget as HTMLElement;
  const all = [...here.closest(".region")!.querySelectorAll<HTMLElement>(".panel > summary")].filter((each) => each.checkVisibility());
  way(all, all.indexOf(here))?.focus();
  event.preventDefault();
}
