/** Details of the picture: what it was read as, what the relief is made of, sizes, parts, and what is doubtful. */
import { make } from "kit/elements";
import type { Note } from "kit/server/messages";
import type { Page } from "kit/page";
import { decimal } from "kit/words/words";
import type { Panel } from "../panel";
import "./found.css";
import { t } from "./words";

const MM = 1000;

function build(page: Page, root: HTMLElement): void {
  const none = make("p", { className: "hint", textContent: t("none") });
  const figures = make("dl", { className: "figures" });
  const notes = make("ul", { className: "notes" });
  root.append(none, figures, notes);
  const noted = new Map<string, Note[]>();
  const show = (): void => {
    const rows = figuresOf(page);
    none.hidden = rows.length > 0;
    figures.replaceChildren(...rows.flatMap(([name, value]) => [term("dt", name), term("dd", value)]));
    const texts = [...noted.values()].flat().filter(({ kind }) => kind !== "decision").map(({ text }) => text);
    notes.replaceChildren(...[...new Set(texts)].map((text) => make("li", { textContent: text })));
  };
  page.hub.on("document", show);
  page.hub.on("shown", show);
  page.hub.on("plan", ({ steps }) => {
    for (const product of noted.keys()) if (!steps.some((each) => each.product === product)) noted.delete(product);
    for (const { product, notes } of steps) noted.set(product, notes);
    show();
  });
  page.hub.on("stage", ({ product, done }) => {
    if (!done.outcome) return;
    noted.set(product, done.notes ?? []);
    show();
  });
}

/** Return what is known of the picture, as names and values. */
function figuresOf({ document: opened, scene }: Pick<Page, "document" | "scene">): [string, string][] {
  const rows: [string, string][] = [];
  if (opened?.scene_kind) rows.push([t("readAs"), t(`is_${opened.scene_kind}`)]);
  if (opened?.relief_from) rows.push([t("reliefFrom"), t(`from_${opened.relief_from}`)]);
  if (!scene) return rows;
  const { extent_m, height_m, labels, parts } = scene.meta;
  rows.push([t("size"), t("sizeMm", { width: decimal(MM * extent_m[0], 0), length: decimal(MM * extent_m[1], 0) })]);
  rows.push([t("heights"), t("heightsMm", { low: decimal(MM * height_m[0], 1), high: decimal(MM * height_m[1], 1) })]);
  if (labels) rows.push([t(parts?.some(Boolean) ? "parts" : "segments"), String(labels)]);
  return rows;
}

function term(tag: "dt" | "dd", textContent: string): HTMLElement {
  return Object.assign(document.createElement(tag), { textContent });
}

export const found: Panel = { id: "found", title: t("title"), task: "picture", open: true, build };
