/** The export panel: choose exporters, run them, stop, and download the files. */
import { button, field, hint, make, paragraph } from "kit/elements";
import { recall, remember } from "kit/preferences";
import { DocumentEditor } from "../../forms/editor";
import { options } from "../../forms/kinds";
import { alternatives, type FileSchema } from "../../forms/schema";
import type { Plain } from "kit/server/messages";
import { isMap, same } from "../../forms/values";
import type { Exported } from "kit/server/messages";
import type { Page } from "kit/page";
import { language } from "kit/words/words";
import { t } from "./words";
import type { Cure } from "../verdicts/verdicts";
import { Choices, type Exporter } from "./choices";
import { equals } from "./entries";
import { address, outcomes, formatBytes } from "./outcomes";
import { Previews } from "./previews";
import { progress } from "./progress";

export function build(page: Page, root: HTMLElement): Promise<void> {
  const editor = new DocumentEditor(page);
  const status = document.createElement("p");
  status.setAttribute("role", "status");
  status.id = "export-status";
  status.tabIndex = -1;
  const tell = (text: string, className = ""): void => void Object.assign(status, { textContent: text, className });
  editor.onRefused = (why) => tell(why, "bad");
  const list = make("div", { textContent: t("waiting") });
  const results = document.createElement("div");
  const previews = new Previews(page);
  let choices: Choices | null = null;
  let shown: Plain | undefined;
  /** Exporters that were run last, for a file that lists none. */
  let lastTime = (): Plain => [];
  const preview = (): void => previews.show(choices?.blocks ?? []);

  const said = (): Plain | undefined => (page.document?.said?.export ?? undefined) as Plain | undefined;
  const names = (): string[] => (choices?.blocks ?? []).map((each) => String(isMap(each) ? each.use : each));
  const follow = (): void => {
    if (!choices || same(said(), shown)) return;
    shown = said();
    choices.show(shown ?? lastTime());
    preview();
  };
  const load = async (): Promise<void> => {
    const schema = await page.net.ask<FileSchema>("schema");
    const exporters = exportersOf(schema);
    lastTime = () => recall(LAST, FIRST).split(" ").filter((name) => exporters.some((each) => each.name === name));
    choices = new Choices(exporters);
    shown = said();
    choices.show(shown ?? lastTime());
    choices.onChange = preview;
    list.replaceChildren(choices.root);
    preview();
  };
  const run = async (exports = choices?.blocks ?? []): Promise<void> => {
    if (!exports.length) return tell(t("none"), "warn");
    tell(t("running"));
    try {
      await title.written;
      const outcome = await page.net.ask<Exported | null>("export", { exports, language });
      if (outcome) tell(...summaryOf(outcome, download(outcome)));
      else tell(t("stopped"), "warn");
    } catch (error) {
      tell((error as Error).message, "bad");
    }
    lookAt(root, status);
  };
  const add = async (): Promise<void> => {
    const exports = choices?.blocks ?? [];
    if (equals(said(), exports)) return tell(t("same"));
    shown = exports.length ? exports : undefined;
    const change = exports.length ? { changes: { export: exports } } : { removed: ["export"] };
    if (await editor.submit(change)) tell(t("added"));
  };
  const title = titleField(page, tell);
  const cure: Cure = (key, value) => {
    const [kind, use, option] = key.split(".");
    if (kind === "export" && use && option && choices?.change(use, option, value)) return void run();
    void editor.submit({ changes: { [key]: value } }).then((done) => (done ? run() : undefined));
  };

  const send = button(t("send"), () => {
    const chosen = choices?.blocks.find((each) => each === SENT || (isMap(each) && each.use === SENT));
    return run([chosen ?? SENT]);
  });
  send.id = "export-send";
  const start = button(t("run"), () => (remember(LAST, names().join(" ")), run()), { id: "export-run", className: "primary" });
  const buttons = make("div", { className: "buttons" });
  buttons.append(start, stopButton(page), button(t("add"), add));
  root.append(...title.elements, send, hint(t("sendAbout")), hint(t("about")), list, previews.root, buttons, progress(page, names), status, results);
  const loaded = load().catch((error: Error) => void (list.textContent = error.message));

  const stale = paragraph(t("stale"), "warn");
  let exported: Exported | null = null;
  const age = (): void => void (stale.hidden = !exported || exported.digest === page.document?.digest);
  const show = (fresh: Exported): void => {
    exported = fresh;
    results.replaceChildren(stale, ...outcomes(fresh, cure), ...zipButton(page, fresh, tell));
    age();
  };
  page.hub.on("exported", show);
  page.hub.on("document", () => {
    follow();
    age();
    preview();
  });
  const before = page.hub.last("exported");
  if (before) show(before);
  return loaded;
}

/** Preference of the exporters that were run last, and those of a first time. */
const LAST = "exports";
const FIRST = "swell";
/** The exporter of a page to send. */
const SENT = "page";
/** Order of known exporters by frequency of use; others follow. */
const ORDER = ["page", "stl", "3mf", "glb", "swell", "pins", "text", "heights"];

/** Return installed exporters with their options, from the file's schema. */
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

/** Return a button that stops the computation. */
function stopButton(page: Page): HTMLElement {
  const stop = button(t("stop"), () => page.net.ask("stop_making"), { id: "export-stop", hidden: true });
  page.hub.on("making", ({ want }) => (stop.hidden = want !== "export"));
  for (const name of ["made", "gone"] as const) page.hub.on(name, () => (stop.hidden = true));
  return stop;
}

/** Lead the eye and the focus to the result, unless the person is elsewhere by now. */
function lookAt(root: HTMLElement, status: HTMLElement): void {
  const { activeElement } = document;
  if (activeElement && activeElement !== document.body && !root.contains(activeElement)) return;
  status.focus({ preventScroll: true });
  status.scrollIntoView({ block: "nearest" });
}

/** Download the only file, or the first PDF of several; return its name, empty without one. */
function download({ folder, exports }: Exported): string {
  const files = exports.flatMap((each) => each.files.map(({ name }) => name));
  const name = files.length === 1 ? files[0]! : (files.find((each) => each.endsWith(".pdf")) ?? "");
  if (name) make("a", { href: address(folder, name), download: name }).click();
  return name;
}

/** Return the field of the title: the document's, which the picture's own is at first. `written`: once it is in the document. */
function titleField(page: Page, tell: (text: string, className?: string) => void): { elements: HTMLElement[]; written: Promise<unknown> } {
  const input = make("input", { id: "export-title", type: "text", autocomplete: "off", maxLength: 200 });
  const about = make("p", { id: "export-title-hint", className: "hint", textContent: t("titleAbout") });
  input.setAttribute("aria-describedby", about.id);
  const said = (key: string): string => String(page.document?.said?.[key] ?? "");
  const show = (): void => {
    if (document.activeElement !== input) input.value = said("title");
  };
  input.onchange = () => {
    const title = input.value.trim();
    const changes = { title, ...(said("language") || language === "en" ? {} : { language }) };
    const edit = title ? { changes } : { removed: ["title"] };
    made.written = page.net.ask("set", edit).catch((error: Error) => tell(error.message, "bad"));
  };
  page.hub.on("document", show);
  show();
  const made = { elements: [field(t("title"), input), about], written: Promise.resolve() as Promise<unknown> };
  return made;
}

function summaryOf({ exports }: Exported, downloaded: string): [string, string] {
  const count = exports.reduce((sum, { files }) => sum + files.length, 0);
  const wrong = exports.filter(({ outcome }) => outcome === "failed" || outcome === "refused").length;
  if (!count) return [t("nothing"), "bad"];
  const also = downloaded && ` ${t("downloaded", { name: downloaded })}`;
  if (wrong) return [t("partly", { count, wrong }) + also, "warn"];
  return [(count === 1 ? t("doneOne") : t("done", { count })) + also, "good"];
}

/** Return a button that downloads all files as a ZIP, if there are several. */
function zipButton(page: Page, { folder, exports }: Exported, tell: (text: string, className?: string) => void): HTMLElement[] {
  const files = exports.flatMap((each) => each.files);
  if (files.length < 2) return [];
  const all = button(t("size", { name: t("all"), size: formatBytes(files.reduce((sum, { bytes }) => sum + bytes, 0)) }), async () => {
    tell(t("packing"));
    try {
      const name = await page.net.ask<string>("export_zip", { folder });
      const link = make("a", { href: address(folder, name), download: name });
      link.click();
      tell("");
    } catch (error) {
      tell((error as Error).message, "bad");
    }
  });
  all.id = "export-zip";
  return [all];
}
