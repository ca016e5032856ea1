/** Browser of folders on this computer: one file or a pair is chosen from a list. */
import { button, field, make } from "kit/elements";
import type { Server } from "kit/page";
import { t } from "./words";

type Kind = "folder" | "picture" | "video" | "heights" | "recording" | "pipeline";

interface Listed {
  folder: string;
  parent: string;
  entries: { name: string; kind: Kind }[];
  more: number;
}

/** Return the browser of folders in a box that opens and closes; when it is opened first, the current folder is listed. */
export function folder(net: Server, open: (paths: string[]) => void, say: (text: string) => void): HTMLElement {
  const box = document.createElement("details");
  const heading = make("summary", { textContent: t("folder") });
  const path = make("input", { id: "open-folder", spellcheck: false });
  const list = make("select", { id: "open-entries", multiple: true, size: 8 });
  const status = document.createElement("p");
  let shown: Listed | null = null;
  let round = 0;

  async function show(place: string): Promise<void> {
    const before = path.value;
    const now = ++round;
    try {
      const listed = await net.ask<Listed>("folder", { path: place });
      if (now !== round) return; // a newer place was requested
      shown = listed;
    } catch (error) {
      return say((error as Error).message);
    }
    if (path.value === before) {
      path.value = shown.folder;
      if (document.activeElement === path) path.select(); // it came late: what is typed next takes its place
    }
    list.replaceChildren(
      ...shown.entries.map(({ name, kind }) => new Option(t("entry", { name, kind: t(`kind_${kind}`) }), name)),
    );
    status.textContent = !shown.entries.length ? t("nothing") : shown.more ? t("more", { count: shown.more }) : "";
  }

  function chosen(): void {
    const names = [...list.selectedOptions].map((option) => option.value);
    const into = shown?.entries.find(({ name, kind }) => kind === "folder" && names.includes(name));
    if (!shown || !names.length || names.length > 2) say(t("chooseFirst"));
    else if (into) void show(`${shown.folder}/${into.name}`);
    else open(names.map((name) => `${shown!.folder}/${name}`));
  }

  path.onchange = () => void show(path.value);
  list.ondblclick = chosen;
  list.onkeydown = (event) => {
    if (event.key === "Enter") chosen();
  };
  // A path may have been typed by then.
  box.addEventListener("toggle", () => box.open && !shown && void show(path.value));
  box.append(
    heading,
    field(t("folder"), path),
    button(t("go"), () => void show(path.value)),
    button(t("up"), () => void show(shown?.parent ?? "")),
    field(t("entries"), list),
    status,
    button(t("openChosen"), chosen),
  );
  return box;
}
