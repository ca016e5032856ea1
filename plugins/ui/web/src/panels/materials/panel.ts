/** Materials of the segments with reasons and areas; and the library with figures and sources. */
import { foldable, make, tableWithHeads } from "kit/elements";
import { DocumentEditor } from "../../forms/editor";
import { LIBRARY } from "../../forms/rows";
import type { Material, Segment } from "kit/server/messages";
import type { Page } from "kit/page";
import { materialWord } from "kit/words/material_words";
import { shownNumber } from "kit/words/part_words";
import { decimal, notation } from "kit/words/words";
import type { Panel } from "../panel";
import { t } from "./words";
import { materialEdit } from "./edit";
import "./materials.css";

type Listed = Material & { source: string };

function build(page: Page, root: HTMLElement): void {
  const editor = new DocumentEditor(page);
  const none = make("p", { className: "hint", textContent: t("none") });
  const refused = make("p", { className: "bad" });
  refused.setAttribute("role", "status");
  editor.onRefused = (why) => (refused.textContent = why);
  const table = tableWithHeads(t("segments"), [t("segment"), t("material"), t("share")], "materials");
  const body = table.createTBody();
  const library = foldable(t("libraryAlone"));
  const heading = library.querySelector("summary")!;
  const list = make("datalist", { id: LIBRARY });
  root.append(none, refused, table, library, list);
  let names: string[] = [];
  let segments: Segment[] = [];
  let of = "";

  const show = (): void => {
    none.hidden = segments.length > 0;
    table.hidden = !segments.length;
    while (body.rows.length > segments.length) body.deleteRow(-1);
    segments.forEach((each, at) => fill(body.rows[at] ?? line(body.insertRow()), each, names));
  };
  const load = async (): Promise<void> => {
    const file = JSON.stringify(page.document?.values?.materials ?? "");
    if (!page.document?.values || of === file) return;
    of = file;
    const listed = await page.net.ask<Listed[]>("library").catch(() => null);
    if (!listed) return void (of = "");
    names = listed.map(({ name }) => name);
    list.replaceChildren(...names.map((each) => new Option(materialWord(each), each)));
    heading.textContent = t("library", { count: listed.length });
    library.replaceChildren(heading, figures(listed));
    show();
  };
  page.hub.on("materials", (message) => {
    segments = message.segments;
    refused.textContent = "";
    void page.idle.then(load);
    show();
  });
  body.onchange = ({ target }) => {
    const select = target as HTMLSelectElement;
    const { label, why } = segments[Number(select.dataset.at)];
    refused.textContent = "";
    editor.change(materialEdit(page.document?.said, label, select.value, why));
  };
}

function line(row: HTMLTableRowElement): HTMLTableRowElement {
  const label = make("th", { scope: "row" });
  const select = document.createElement("select");
  const why = make("p", { className: "hint" });
  row.append(label);
  row.insertCell().append(select, why);
  row.insertCell().className = "number";
  return row;
}

/** Fill a row in place, so that a focused select keeps the focus. */
function fill(row: HTMLTableRowElement, { label, material, why, share }: Segment, names: string[]): void {
  const [head, choice, area] = row.cells;
  head.textContent = String(shownNumber(label));
  const select = choice.querySelector("select")!;
  select.dataset.at = String(row.sectionRowIndex);
  select.setAttribute("aria-label", t("choose", { number: shownNumber(label) }));
  const all = names.includes(material) ? names : [material, ...names];
  if (select.options.length !== all.length) select.replaceChildren(...all.map((each) => new Option(materialWord(each), each)));
  select.value = material;
  const reason = choice.querySelector("p")!;
  reason.id = `material-why-${label}`;
  reason.textContent = why.replace(/^\S+ \d+: /, "").replace(/ -> .*$/, "");
  select.setAttribute("aria-describedby", reason.id);
  area.textContent = share < 0.0005 ? `< ${decimal(0.1, 1)} %` : `${decimal(100 * share, 1)} %`;
}

function figures(library: Listed[]): HTMLElement {
  const box = make("div", { className: "wide", tabIndex: 0 });
  box.setAttribute("role", "region");
  box.setAttribute("aria-label", t("libraryAlone"));
  const columns = ["name", "stiffness", "damping", "friction", "roughness", "grain", "texture", "source"] as const;
  const table = tableWithHeads(t("libraryAlone"), columns.map((each) => t(each)), "materials");
  const body = table.createTBody();
  for (const each of library) {
    const row = body.insertRow();
    const name = make("th", { scope: "row" });
    name.textContent = materialWord(each.name);
    row.append(name);
    for (const text of [
      each.stiffness_n_per_m, each.damping_n_s_per_m, `${notation(`${each.static_friction}`)} / ${notation(`${each.dynamic_friction}`)}`,
      round(1e6 * each.roughness_m), round(1e3 * each.grain_m), each.texture, each.source,
    ]) row.insertCell().textContent = notation(String(text));
  }
  box.append(table);
  return box;
}

function round(value: number): number {
  return Number(value.toPrecision(3));
}

export const materials: Panel = { id: "materials", title: t("title"), task: "parts", open: false, build };
