/** The start without a file: three tiles in place of the surface. */
import { button, paragraph } from "kit/elements";
import type { Page } from "kit/page";
import { reveal } from "../panels/panel";
import "./start.css";
import { t } from "./words";

/** Show the tiles until a file is opened. */
export function start(page: Pick<Page, "hub" | "net" | "say">): void {
  const box = document.createElement("section");
  box.id = "start";
  const title = Object.assign(document.createElement("h2"), { id: "start-title", textContent: t("title") });
  box.setAttribute("aria-labelledby", title.id);
  const tiles = Object.assign(document.createElement("div"), { className: "tiles" });
  const examples = Object.assign(document.createElement("div"), { className: "buttons" });
  tiles.append(
    tile(t("picture"), t("pictureSays"), primary(button(t("choose"), () => document.getElementById("open-files")!.click()))),
    tile(t("example"), t("exampleSays"), examples),
    tile(t("file"), t("fileSays"), button(t("folder"), chooseFromFolder)),
  );
  box.append(title, tiles);
  document.getElementById("scenery")!.append(box);
  const open = (name: string): void => void page.net.ask("begin", { files: [name] }).catch((error: Error) => page.say(error.message));
  const list = async (): Promise<void> => {
    const names = await page.net.ask<string[]>("examples").catch(() => []);
    examples.replaceChildren(...names.map((name) => button(name.replace("builtin/", ""), () => open(name))));
  };
  if (page.hub.last("maker")) void list();
  page.hub.on("maker", () => void list());
  page.hub.on("document", ({ text }) => {
    if (!text || !box.isConnected) return;
    const focused = box.contains(document.activeElement);
    box.remove();
    if (focused) document.getElementById("terrain")!.focus();
  });
}

function tile(title: string, says: string, control: HTMLElement): HTMLElement {
  const box = Object.assign(document.createElement("section"), { className: "tile" });
  box.append(Object.assign(document.createElement("h3"), { textContent: title }), paragraph(says), control);
  return box;
}

function primary(button: HTMLButtonElement): HTMLButtonElement {
  button.className = "primary";
  return button;
}

/** Open the folders of this computer in the panel that opens files. */
function chooseFromFolder(): void {
  reveal("open");
  const path = document.getElementById("open-folder")!;
  path.closest("details")!.open = true;
  path.focus();
}
