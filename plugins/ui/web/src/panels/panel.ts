/** A panel of the page: a part of it that stands for itself. */
import type { Page } from "../page";
import { recall, remember } from "../preferences";
import { t } from "../frame/words";

export interface Panel {
  id: string;
  title: string;
  /** Left: what is made. Right: what is seen, heard and felt. Bottom: what happened. */
  place: "left" | "right" | "bottom";
  /** Whether it is open until a person says otherwise. */
  open: boolean;
  /** Called once, open or not. In `root` headings are <h3>; the classes for controls stand at the top of app.css. */
  build(page: Page, root: HTMLElement): void;
}

const WAYS: Record<string, (all: HTMLElement[], at: number) => HTMLElement | undefined> = {
  ArrowDown: (all, at) => all[at + 1],
  ArrowUp: (all, at) => all[at - 1],
  Home: (all) => all[0],
  End: (all) => all.at(-1),
};

/** Put panels where they belong, each under a heading that opens and closes it. One that fails leaves the others. */
export function build(page: Page, panels: Panel[]): void {
  for (const panel of panels) {
    const root = place(panel);
    try {
      panel.build(page, root);
    } catch (error) {
      root.textContent = t("panelFailed", { error: String(error) });
      root.classList.add("bad");
      console.error(error);
    }
  }
}

/** Open a panel and go to its heading. */
export function reveal(id: string): void {
  const box = document.getElementById(id) as HTMLDetailsElement;
  box.open = true;
  box.querySelector("summary")!.focus();
  box.scrollIntoView({ block: "nearest" });
}

function place(panel: Panel): HTMLElement {
  const box = document.createElement("details");
  box.id = panel.id;
  box.className = "panel";
  box.open = recall(`panel.${panel.id}`, panel.open);
  box.addEventListener("toggle", () => remember(`panel.${panel.id}`, box.open));
  const heading = document.createElement("summary");
  const title = document.createElement("h2");
  title.textContent = panel.title;
  heading.append(title);
  heading.addEventListener("keydown", walk);
  heading.addEventListener("click", () => remember(`panel.${panel.id}`, !box.open)); // "toggle" comes later than a reload may
  const root = document.createElement("div");
  root.className = "inside";
  box.append(heading, root);
  document.getElementById(panel.place)!.append(box);
  return root;
}

/** The arrow keys go from heading to heading within a region. */
function walk(event: KeyboardEvent): void {
  const way = WAYS[event.key];
  if (!way) return;
  const here = event.currentTarget as HTMLElement;
  const all = [...here.closest(".region")!.querySelectorAll<HTMLElement>(".panel > summary")];
  way(all, all.indexOf(here))?.focus();
  event.preventDefault();
}
