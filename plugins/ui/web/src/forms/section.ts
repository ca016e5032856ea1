/** Form of a section of the file: method and options, rarer ones folded. */
import type { Document } from "kit/server/messages";
import { t } from "./words";
import { FIELD, rows } from "./rows";
import { PLAIN, type Method, type Section } from "./sections";
import type { Option as Choice } from "./kinds";
import type { Plain } from "kit/server/messages";
import { at, type Edit, edit, isMap } from "./values";

export type Change = (edit: Edit) => void;

const NONE = "";

export class SectionForm {
  readonly root = document.createElement("details");
  private readonly chosen = document.createElement("span");
  private readonly select = document.createElement("select");
  private readonly about = document.createElement("p");
  private readonly fields = document.createElement("div");
  private shows: ((given: Plain | undefined) => void)[] = [];
  private method: string | null = null;
  private said: Document | null = null;

  constructor(private section: Section, private change: Change) {
    const heading = document.createElement("summary");
    const name = document.createElement("h3");
    name.textContent = t.has(section.name) ? t(section.name) : section.title;
    this.chosen.className = "chosen";
    heading.append(name, this.chosen);
    this.root.className = "section";
    this.root.id = `section-${section.name}`;
    this.root.append(heading);
    if (section.methods.length) this.root.append(this.choice());
    this.about.className = "hint about";
    this.root.append(this.about, this.fields);
    if (!section.methods.length) this.build(null, section.options);
  }

  /** Show the document; a control being edited keeps its text. */
  show(document: Document): void {
    this.said = document;
    const written = this.block(document);
    if (this.section.methods.length) this.choose(written);
    else this.chosen.textContent = "";
    for (const each of this.shows) each(written);
  }

  private block({ said }: Document): Plain | undefined {
    const block = at(said, [this.section.name]);
    if (this.section.name === "materials" && isLabels(block)) return { by: block! };
    if (this.section.word && typeof block === "string") return { [this.section.word]: block };
    return typeof block === "string" && this.section.methods.length ? { use: block } : block;
  }

  private choose(said: Plain | undefined): void {
    const use = isMap(said) ? said.use : undefined;
    const method = this.section.methods.find(({ name }) => name === use);
    this.chosen.textContent = use === undefined ? t("noMethod") : String(use);
    this.select.value = method?.name ?? NONE;
    if (this.method === (method?.name ?? NONE)) return;
    this.method = method?.name ?? NONE;
    this.about.textContent = method?.about.split("\n")[0] ?? "";
    this.build(method ?? null, method?.options ?? []);
  }

  private choice(): HTMLElement {
    const box = document.createElement("div");
    box.className = "field";
    this.select.id = `${FIELD}${this.section.name}`;
    this.select.add(new Option(t("noMethod"), NONE));
    for (const { name } of this.section.methods) this.select.add(new Option(name, name));
    this.select.onchange = () => {
      const { value } = this.select;
      this.change(value === NONE ? { removed: [this.section.name] } : { changes: { [`${this.section.name}.use`]: value } });
    };
    const label = document.createElement("label");
    label.htmlFor = this.select.id;
    label.textContent = t("method");
    const complaint = document.createElement("p");
    complaint.id = `${this.select.id}-complaint`;
    complaint.className = "bad complaint";
    complaint.hidden = true;
    this.about.id = `${this.select.id}-hint`;
    this.select.setAttribute("aria-describedby", `${complaint.id} ${this.about.id}`);
    box.append(label, this.select, complaint);
    return box;
  }

  private build(_: Method | null, options: Choice[]): void {
    const row = rows((key) => at(this.said?.values, key.split(".")));
    const made = options.map((option) => {
      const key = `${this.section.name}.${option.name}`;
      const tell = (typed: Parameters<typeof edit>[1], inside: string[] = []): void =>
        this.change(edit([key, ...inside].join("."), typed));
      const one = row(option, `${FIELD}${key}`, tell);
      const show = (said: Plain | undefined): void => {
        const value = at(said, [option.name]);
        one.show(value, value !== undefined);
      };
      return { root: one.root, show };
    });
    this.shows = made.map(({ show }) => show);
    const roots = made.map(({ root }) => root);
    const fold = roots.length > PLAIN + 1 ? PLAIN : roots.length;
    this.fields.replaceChildren(...roots.slice(0, fold));
    if (fold < roots.length) this.fields.append(this.foldRest(options.slice(fold), roots.slice(fold)));
  }

  private foldRest(options: Choice[], roots: HTMLElement[]): HTMLElement {
    const box = document.createElement("details");
    box.className = "more";
    const heading = document.createElement("summary");
    box.append(heading, ...roots);
    this.shows.push((said) => {
      const set = isMap(said) ? options.filter(({ name }) => name in said).length : 0;
      heading.textContent = set ? t("moreSet", { count: options.length, set }) : t("more", { count: options.length });
    });
    return box;
  }
}

/** Return whether a block of materials is a short map from label to material. */
export function isLabels(block: Plain | undefined): boolean {
  return isMap(block) && Object.keys(block).some((key) => /^\d+$/.test(key));
}
