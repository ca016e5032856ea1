/** Choose exporters, run them, stop, and take the files. */
import { button, hint, paragraph } from "../../elements";
import { Editor } from "../../forms/editor";
import { options } from "../../forms/kinds";
import { alternatives, type FileSchema, type Plain } from "../../forms/schema";
import { same } from "../../forms/values";
import type { Exported } from "../../server/messages";
import type { Page } from "../../page";
import { t } from "./words";
import { made } from "../../words/product_words";
import type { Cure } from "../verdicts/verdicts";
import { Choices, type Exporter } from "./choices";
import { says } from "./entries";
import { address, outcomes, sized } from "./outcomes";

export function build(page: Page, root: HTMLElement): void {
  const editor = new Editor(page);
  const told = document.createElement("p");
  told.setAttribute("role", "status");
  const tell = (text: string, className = ""): void => void Object.assign(told, { textContent: text, className });
  editor.onRefused = (why) => tell(why, "bad");
  const list = document.createElement("div");
  list.textContent = t("waiting");
  const results = document.createElement("div");
  let choices: Choices | null = null;
  let shown: Plain | undefined;

  const said = (): Plain | undefined => (page.document?.said?.export ?? undefined) as Plain | undefined;
  const follow = (): void => {
    if (!choices || same(said(), shown)) return;
    shown = said();
    choices.show(shown);
  };
  const load = async (): Promise<void> => {
    const found = await page.net.ask<FileSchema>("schema");
    choices = new Choices(exportersOf(found));
    shown = said();
    choices.show(shown);
    list.replaceChildren(choices.root);
  };
  const run = async (): Promise<void> => {
    const exports = choices?.blocks ?? [];
    if (!exports.length) return tell(t("none"), "warn");
    tell(t("running"));
    try {
      const found = await page.net.ask<Exported | null>("export", { exports });
      if (found) tell(...inWords(found));
      else tell(t("stopped"), "warn");
    } catch (error) {
      tell((error as Error).message, "bad");
    }
  };
  const add = async (): Promise<void> => {
    const exports = choices?.blocks ?? [];
    if (says(said(), exports)) return tell(t("same"));
    shown = exports.length ? exports : undefined;
    const change = exports.length ? { changes: { export: exports } } : { removed: ["export"] };
    if (await editor.changed(change)) tell(t("added"));
  };
  const cure: Cure = (key, value) => {
    void editor.changed({ changes: { [key]: value } }).then((done) => (done ? run() : undefined));
  };

  const start = button(t("run"), run);
  start.id = "export-run";
  start.className = "primary";
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(start, stopping(page), button(t("add"), add));
  root.append(hint(t("about")), list, buttons, progress(page), told, results);
  void load().catch((error: Error) => (list.textContent = error.message));

  const stale = paragraph(t("stale"), "warn");
  let exported: Exported | null = null;
  const age = (): void => void (stale.hidden = !exported || exported.digest === page.document?.digest);
  const show = (fresh: Exported): void => {
    exported = fresh;
    results.replaceChildren(stale, ...outcomes(fresh, cure), ...packed(page, fresh, tell));
    age();
  };
  page.hub.on("exported", show);
  page.hub.on("document", () => {
    follow();
    age();
  });
  const before = page.hub.last("exported");
  if (before) show(before);
}

/** What most look for comes first; exporters that are not known here follow. */
const ORDER = ["stl", "3mf", "glb", "swell", "pins", "text", "heights"];

/** Exporters that are installed, with their options, of the file's schema. */
function exportersOf({ properties, $defs }: FileSchema): Exporter[] {
  const lists = properties.export ? alternatives(properties.export, $defs) : [];
  const items = lists.flatMap((each) => (each.items ? alternatives(each.items, $defs) : [each]));
  const blocks = items.filter((each) => each.properties?.use);
  const found = blocks.map((each) => ({
    name: String(each.properties!.use.const),
    about: (each.description ?? "").trim(),
    options: options(each, $defs),
  }));
  const place = ({ name }: Exporter): number => (ORDER.includes(name) ? ORDER.indexOf(name) : ORDER.length);
  return found.sort((one, other) => place(one) - place(other));
}

/** It ends what is being made, as everywhere. */
function stopping(page: Page): HTMLElement {
  const stop = button(t("stop"), () => page.net.ask("stop_making"));
  stop.id = "export-stop";
  stop.hidden = true;
  page.hub.on("making", ({ want }) => (stop.hidden = want !== "export"));
  for (const name of ["made", "gone"] as const) page.hub.on(name, () => (stop.hidden = true));
  return stop;
}

/** What is being made for it now. Not spoken: the status says when it begins and ends. */
function progress(page: Page): HTMLElement {
  const box = document.createElement("p");
  box.className = "hint progress";
  box.hidden = true;
  const bar = document.createElement("progress");
  bar.setAttribute("aria-label", t("running"));
  const text = document.createElement("span");
  box.append(bar, text);
  page.hub.on("making", ({ want }) => {
    box.hidden = want !== "export";
    text.textContent = "";
  });
  page.hub.on("stage", ({ product, done }) => {
    if (!done.outcome) text.textContent = t("making", { product: made(product) });
  });
  for (const name of ["made", "gone"] as const) page.hub.on(name, () => (box.hidden = true));
  return box;
}

function inWords({ exports }: Exported): [string, string] {
  const count = exports.reduce((sum, { files }) => sum + files.length, 0);
  const wrong = exports.filter(({ outcome }) => outcome === "failed" || outcome === "refused").length;
  if (!count) return [t("nothing"), "bad"];
  if (wrong) return [t("partly", { count, wrong }), "warn"];
  return [count === 1 ? t("doneOne") : t("done", { count }), "good"];
}

/** All files in one, where there are several. */
function packed(page: Page, { folder, exports }: Exported, tell: (text: string, className?: string) => void): HTMLElement[] {
  const files = exports.flatMap((each) => each.files);
  if (files.length < 2) return [];
  const all = button(t("size", { name: t("all"), size: sized(files.reduce((sum, { bytes }) => sum + bytes, 0)) }), async () => {
    tell(t("packing"));
    try {
      const name = await page.net.ask<string>("export_zip", { folder });
      const link = document.createElement("a");
      Object.assign(link, { href: address(folder, name), download: name });
      link.click();
      tell("");
    } catch (error) {
      tell((error as Error).message, "bad");
    }
  });
  all.id = "export-zip";
  return [all];
}
