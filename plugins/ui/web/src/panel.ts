/** A panel of the page: a part of it that stands for itself. */
import type { Page } from "./page";

export interface Panel {
  id: string;
  title: string;
  place: "left" | "right" | "bottom";
  /** Whether it is open at first. */
  open: boolean;
  build(page: Page, root: HTMLElement): void;
}

/** Put panels where they belong, each under a heading that opens and closes it. */
export function build(page: Page, panels: Panel[]): void {
  for (const panel of panels) {
    const box = document.createElement("details");
    box.id = panel.id;
    box.className = "panel";
    box.open = panel.open;
    const heading = document.createElement("summary");
    const title = document.createElement("h2");
    title.textContent = panel.title;
    heading.append(title);
    const root = document.createElement("div");
    root.className = "inside";
    box.append(heading, root);
    document.getElementById(panel.place)!.append(box);
    panel.build(page, root);
  }
}
