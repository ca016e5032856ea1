/** The button and the key that open the command palette, which is loaded then. */
import type { Page } from "kit/page";
import { caps } from "kit/key_caps";
import { on, SHORTCUTS } from "kit/shortcuts";
import { t } from "./words";

export function findCommands(page: Pick<Page, "hub" | "canvas" | "say">): void {
  const open = (): void => void import("./palette").then((palette) => palette.open(page));
  const button = document.getElementById("find") as HTMLButtonElement;
  button.querySelector("span")!.textContent = t("find");
  button.append(caps(SHORTCUTS.palette.keys[0]));
  button.setAttribute("aria-keyshortcuts", "Control+K");
  button.setAttribute("aria-haspopup", "dialog");
  button.onclick = open;
  on("palette", open);
}
