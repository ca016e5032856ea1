/** Open pictures, pairs, height maps, recordings, pipeline files and examples. */
import { button, field, foldable, make } from "kit/elements";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "./words";
import { camera } from "./camera";
import { onDrop } from "./drop";
import { folder } from "./folder";
import { draftOffer } from "./draft";
import { uploadAndOpen, type Opened } from "./upload";
import "./open.css";

function build(page: Page, root: HTMLElement): void {
  const status = make("p", { className: "told" });
  const say = (text: string): void => {
    status.textContent = text;
    page.say(text);
  };

  async function openAndTell(names: string, work: Promise<Opened>): Promise<void> {
    say(t("opening", { names }));
    try {
      const { recording } = await work;
      if (recording) page.hub.tell("recording", { path: recording });
      say(t("opened", { names }));
    } catch (error) {
      say(t("failed", { why: (error as Error).message }));
    }
  }

  const progress = (name: string, percent: number): string => (status.textContent = t("sending", { name, percent }));
  const take = (files: File[]): void => {
    if (files.length) void openAndTell(files.map(({ name }) => name).join(", "), uploadAndOpen(page.net, files, progress));
  };
  const open = (paths: string[]): void =>
    void openAndTell(paths.map((path) => path.split("/").at(-1)).join(", "), page.net.ask<Opened>("begin", { files: paths }));

  onDrop(take);
  root.append(
    draftOffer(page),
    ...chooser(take),
    examples(page, open),
    folder(page.net, open, say),
    foldable(t("camera"), camera(take, say)),
    exchange(page),
    status,
  );
}

function chooser(take: (files: File[]) => void): HTMLElement[] {
  const input = make("input", { type: "file", id: "open-files", multiple: true });
  const help = make("small", { id: "open-files-help", textContent: t("chooseHelp") });
  input.setAttribute("aria-describedby", help.id);
  input.onchange = () => {
    take([...(input.files ?? [])]);
    input.value = ""; // allow choosing the same file again
  };
  return [field(t("choose"), input), help];
}

function examples(page: Page, open: (paths: string[]) => void): HTMLElement {
  const list = make("div", { className: "examples" });
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
  const title = make("h3", { textContent: t("examples") });
  const box = document.createElement("div");
  box.append(title, list);
  return box;
}

/** Return a button that swaps left and right of a pair in the document. */
function exchange(page: Page): HTMLElement {
  const toggle = button(t("exchange"), () => page.net.ask("exchange").catch((error: Error) => page.say(error.message)));
  toggle.hidden = true;
  page.hub.on("document", ({ values }) => {
    const scene = values?.scene;
    toggle.hidden = !(scene && typeof scene === "object" && "left" in scene && "right" in scene);
  });
  return toggle;
}

export const open: Panel = { id: "open", title: t("title"), task: "picture", open: true, build };
