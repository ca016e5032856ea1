/** Selection of exporters with options, local to the panel until written into the file. */
import { button, labelled, make, paragraph } from "kit/elements";
import type { Option } from "../../forms/kinds";
import { FIELD, rows } from "../../forms/rows";
import type { Plain } from "kit/server/messages";
import { setInside, type FieldChange } from "../../forms/values";
import { t } from "./words";
import { blocksOf, entriesOf, type Entry } from "./entries";

export interface Exporter {
  name: string;
  about: string;
  options: Option[];
}

/** Return the name of an exporter; an unknown one keeps the name of the pipeline file. */
export const exporterName = (name: string): string => (t.has(name) ? t(name) : name);

export class Choices {
  readonly root = document.createElement("ul");
  /** Called when the selection or an option changed. */
  onChange: () => void = () => undefined;
  private entries: Entry[] = [];

  constructor(private exporters: Exporter[]) {
    this.root.className = "exporters";
    this.root.setAttribute("aria-label", t("what"));
  }

  get blocks(): Plain[] {
    return blocksOf(this.entries);
  }

  /** Show the file's exporters. */
  show(value: Plain | undefined): void {
    this.build(entriesOf(value, this.exporters.map(({ name }) => name)));
  }

  /** Change an option of an exporter that is chosen; return whether one is. */
  change(use: string, option: string, value: Plain): boolean {
    const entry = this.entries.find((each) => each.on && each.use === use);
    if (!entry) return false;
    entry.options = { ...entry.options, [option]: value };
    this.build(this.entries);
    this.onChange();
    return true;
  }

  private build(entries: Entry[]): void {
    this.entries = entries;
    this.root.replaceChildren(...entries.map((entry, at) => this.line(entry, at)));
  }

  private line(entry: Entry, at: number): HTMLElement {
    const box = document.createElement("li");
    const input = make("input", { type: "checkbox", checked: entry.on, id: `export-${at}-${entry.use}` });
    input.onchange = () => {
      entry.on = input.checked;
      this.onChange();
    };
    box.append(labelled(input, exporterName(entry.use)));
    const known = this.exporters.find(({ name }) => name === entry.use); // a file may name an exporter that is not installed
    if (known) box.append(this.options(entry, at, known, input));
    return box;
  }

  private options(entry: Entry, at: number, known: Exporter, on: HTMLInputElement): HTMLElement {
    const box = make("details", { className: "more" });
    const heading = document.createElement("summary");
    const name = make("span", { className: "visually-hidden" });
    name.textContent = t("optionsOf", { name: exporterName(entry.use) });
    const about = paragraph(known.about.split("\n")[0], "hint");
    const count = (): void => {
      const set = Object.keys(entry.options).length;
      heading.replaceChildren(set ? t("optionsSet", { set }) : t("options"), name);
    };
    const row = rows(() => undefined);
    const made = known.options.map((option) => {
      const one = row(option, `${FIELD}export-${at}-${entry.use}.${option.name}`, (change: FieldChange, inside: string[] = []) => {
        entry.options = setInside(entry.options, [option.name, ...inside], change) as Entry["options"];
        if (!entry.on) on.click(); // setting options implies the exporter
        show();
        this.onChange();
      });
      return { root: one.root, show: () => one.show(entry.options[option.name], option.name in entry.options) };
    });
    const show = (): void => {
      count();
      for (const each of made) each.show();
    };
    show();
    box.append(heading, about, ...made.map(({ root }) => root), this.more(entry, at));
    return box;
  }

  /** Return buttons to add or remove a variant: two pin displays need two files. */
  private more(entry: Entry, at: number): HTMLElement {
    const box = make("div", { className: "buttons" });
    const again = button(t("another"), () => {
      this.build([...this.entries.slice(0, at + 1), { ...entry, on: true }, ...this.entries.slice(at + 1)]);
      this.open(at + 1);
    });
    again.className = "quiet";
    box.append(again);
    if (this.entries.filter(({ use }) => use === entry.use).length > 1) {
      const remove = button(t("remove"), () => {
        this.build(this.entries.filter((each) => each !== entry));
        this.open(at - 1);
      });
      remove.className = "quiet";
      remove.setAttribute("aria-label", t("removeThis", { name: exporterName(entry.use) }));
      box.append(remove);
    }
    return box;
  }

  private open(at: number): void {
    const line = this.root.children[Math.max(0, at)]!;
    line.querySelector("details")!.open = true;
    line.querySelector("input")!.focus();
    this.onChange();
  }
}
