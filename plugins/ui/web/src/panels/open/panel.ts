/** Open pictures, pairs, height maps, recordings, pipeline files and examples. */
import { button, field } from "../../elements";
import type { Page } from "../../page";
import type { Panel } from "../panel";
import { t } from "./words";
import { camera } from "./camera";
import { onDrop } from "./drop";
import { folder } from "./folder";
import { restored } from "./draft";
import { send, type Opened } from "./upload";
import "./open.css";

function build(page: Page, root: HTMLElement): void {
  const told = document.createElement("p");
  told.className = "told";
  const say = (text: string): void => {
    told.textContent = text;
    page.say(text);
  };

  async function opened(names: string, work: Promise<Opened>): Promise<void> {
    say(t("opening", { names }));
    try {
      const { recording } = await work;
      if (recording) page.hub.tell("recording", { path: recording });
      say(t("opened", { names }));
    } catch (error) {
      say(t("failed", { why: (error as Error).message }));
    }
  }

  const progress = (name: string, percent: number): string => (told.textContent = t("sending", { name, percent }));
  const take = (files: File[]): void => {
    if (files.length) void opened(files.map(({ name }) => name).join(", "), send(page.net, files, progress));
  };
  const open = (paths: string[]): void =>
    void opened(paths.map((path) => path.split("/").at(-1)).join(", "), page.net.ask<Opened>("begin", { files: paths }));

  onDrop(take);
  root.append(
    restored(page),
    ...chooser(take),
    examples(page, open),
    folded(t("folder"), folder(page.net, open, say)),
    folded(t("camera"), camera(take, say)),
    exchange(page),
    told,
  );
}

function chooser(take: (files: File[]) => void): HTMLElement[] {
  const input = document.createElement("input");
  input.type = "file";
  input.id = "open-files";
  input.multiple = true;
  const help = document.createElement("small");
  help.id = "open-files-help";
  help.textContent = t("chooseHelp");
  input.setAttribute("aria-describedby", help.id);
  input.onchange = () => {
    take([...(input.files ?? [])]);
    input.value = ""; // the same file may be chosen again
  };
  return [field(t("choose"), input), help];
}

function examples(page: Page, open: (paths: string[]) => void): HTMLElement {
  const list = document.createElement("div");
  list.className = "examples";
  list.setAttribute("role", "group");
  list.setAttribute("aria-label", t("examples"));
  let asked = false;
  page.hub.on("maker", async () => {
    if (asked) return;
    asked = true;
    const names = await page.net.ask<string[]>("examples").catch(() => []);
    asked = names.length > 0;
    list.replaceChildren(...names.map((name) => button(name.replace("builtin/", ""), () => open([name]))));
  });
  const title = document.createElement("h3");
  title.textContent = t("examples");
  const box = document.createElement("div");
  box.append(title, list);
  return box;
}

/** Left and right of a pair change places in the document. */
function exchange(page: Page): HTMLElement {
  const made = button(t("exchange"), () => page.net.ask("exchange").catch((error: Error) => page.say(error.message)));
  made.hidden = true;
  page.hub.on("document", ({ values }) => {
    const scene = values?.scene;
    made.hidden = !(scene && typeof scene === "object" && "left" in scene && "right" in scene);
  });
  return made;
}

function folded(title: string, inside: HTMLElement): HTMLElement {
  const box = document.createElement("details");
  const heading = document.createElement("summary");
  heading.textContent = title;
  box.append(heading, inside);
  return box;
}

export const open: Panel = { id: "open", title: t("title"), place: "left", open: true, build };
