/** Folders of this computer: what can be opened lies in a list, of which one file or a pair is chosen. */
import { button, field } from "../../elements";
import type { Net } from "../../server/connection";
import { t } from "./words";

type Kind = "folder" | "picture" | "video" | "heights" | "recording" | "pipeline";

interface Listed {
  folder: string;
  parent: string;
  entries: { name: string; kind: Kind }[];
  more: number;
}

export function folder(net: Net, open: (paths: string[]) => void, say: (text: string) => void): HTMLElement {
  const box = document.createElement("div");
  const path = document.createElement("input");
  path.id = "open-folder";
  path.spellcheck = false;
  const list = document.createElement("select");
  list.id = "open-entries";
  list.multiple = true;
  list.size = 8;
  const told = document.createElement("p");
  let shown: Listed | null = null;

  async function show(place: string): Promise<void> {
    try {
      shown = await net.ask<Listed>("folder", { path: place });
    } catch (error) {
      return say((error as Error).message);
    }
    path.value = shown.folder;
    list.replaceChildren(
      ...shown.entries.map(({ name, kind }) => new Option(t("entry", { name, kind: t(`kind_${kind}`) }), name)),
    );
    told.textContent = !shown.entries.length ? t("nothing") : shown.more ? t("more", { count: shown.more }) : "";
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
  box.append(
    field(t("folder"), path),
    button(t("go"), () => void show(path.value)),
    button(t("up"), () => void show(shown?.parent ?? "")),
    field(t("entries"), list),
    told,
    button(t("openChosen"), chosen),
  );
  return box;
}
