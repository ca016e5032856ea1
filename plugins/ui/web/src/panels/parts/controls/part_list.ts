/** List of the parts from front to back, and fields of the selected one. */
import { button, field, hint, make } from "kit/elements";
import { materialWord } from "kit/words/material_words";
import { shownNumber } from "kit/words/part_words";
import { t } from "../editor/words";
import type { Drawing, Part } from "../drawing/drawing";
import { frontToBack } from "../drawing/order";
import { nameOf, heightOf } from "../editor/part_words";

/** Steps of the keys in the list, metres. */
const STEPS_M = { usual: 0.0002, fine: 0.00005, coarse: 0.001 };
const MM = 1000;

export class PartList {
  readonly list = document.createElement("ul");
  readonly said = document.createElement("fieldset");
  readonly name = input("parts-name", "text");
  /** Returns the number by which people know a part. */
  numberOf: (label: number) => number = shownNumber;
  /** Returns whether changes of a part take effect before saving. */
  isFelt: (label: number) => boolean = () => true;
  neighbours: Part[] = [];
  onSelect: (label: number) => void = () => undefined;
  onReorder: () => void = () => undefined;
  onJoin: (label: number) => void = () => undefined;
  private rows = new Map<number, HTMLLIElement>();
  private height = input("parts-height", "range");
  private exact = input("parts-height-mm", "number");
  private material = select("parts-material");
  private other = select("parts-join");
  private later = hint(t("feltLater"));
  private join = button(t("join"), () => this.other.value && this.onJoin(Number(this.other.value)));
  private complaints = new Map<HTMLElement, HTMLElement>();
  private dragged = false;

  constructor(
    private drawing: Drawing,
    materials: string[],
  ) {
    this.list.setAttribute("role", "listbox");
    this.list.setAttribute("aria-label", t("list"));
    this.list.id = "parts-list";
    this.list.tabIndex = 0;
    this.list.addEventListener("keydown", (event) => this.key(event));
    this.list.addEventListener("click", (event) => {
      const label = (event.target as HTMLElement).closest("li")?.dataset.label;
      if (label === undefined) return;
      this.onSelect(Number(label));
      const isMouse = (event as PointerEvent).pointerType === "mouse"; // a finger would bring up the keyboard of a phone
      if (isMouse && !this.drawing.part(Number(label))?.name) this.name.focus(); // its name is what is missing
    });
    this.material.add(new Option(t("byRules"), ""));
    for (const each of materials) this.material.add(new Option(materialWord(each), each));
    this.build();
  }

  /** Update list and fields. */
  show(): void {
    const { parts, selected } = this.drawing;
    if (!this.dragged) this.showList();
    else for (const part of parts) this.fill(this.rows.get(part.label)!, part);
    this.list.setAttribute("aria-activedescendant", `parts-option-${selected}`);
    const part = this.drawing.part(selected);
    if (part) this.showPart(part);
  }

  private build(): void {
    const legend = make("legend", { textContent: t("selected") });
    const top = String(Math.round(1e5 * this.drawing.top_m) / 100);
    for (const each of [this.height, this.exact]) Object.assign(each, { min: "0", max: top, step: "0.05" });
    this.name.autocomplete = "off";
    this.name.addEventListener("input", () => this.rename());
    this.name.addEventListener("keydown", (event) => event.key === "Enter" && !event.isComposing && this.nameNext());
    this.height.addEventListener("input", () => this.raise(this.height.valueAsNumber / MM, true));
    this.exact.addEventListener("input", () => this.raise(this.exact.valueAsNumber / MM, true));
    for (const each of [this.name, this.height, this.exact]) each.addEventListener("change", () => this.endDrag());
    this.material.addEventListener("change", () => this.set({ material: this.material.value || null }));
    const order = make("div", { className: "buttons" });
    order.append(button(t("forward"), () => this.order(1)), button(t("backward"), () => this.order(-1)));
    const join = make("div", { className: "with-button" });
    join.append(field(t("joinWith"), this.other), this.join);
    this.said.append(
      legend, field(t("name"), this.name), this.complaint(this.name), field(t("height"), this.height),
      field(t("heightMm"), this.exact), this.complaint(this.exact), this.later, field(t("material"), this.material), order, join,
    );
  }

  private complaint(control: HTMLElement): HTMLElement {
    const box = make("p", { className: "bad", id: `${control.id}-complaint`, hidden: true });
    box.setAttribute("role", "alert");
    this.complaints.set(control, box);
    return box;
  }

  /** Show a complaint at a field, none if empty; return whether it is empty. */
  private complain(control: HTMLElement, text: string): boolean {
    const box = this.complaints.get(control)!;
    box.hidden = !text;
    box.textContent = text;
    if (text) {
      control.setAttribute("aria-invalid", "true");
      control.setAttribute("aria-describedby", box.id);
    } else for (const each of ["aria-invalid", "aria-describedby"]) control.removeAttribute(each);
    return !text;
  }

  private showList(): void {
    const wanted = frontToBack(this.drawing.parts);
    for (const [label, row] of this.rows)
      if (!this.drawing.part(label)) {
        row.remove();
        this.rows.delete(label);
      }
    wanted.forEach((part, i) => {
      const row = this.rows.get(part.label) ?? this.row(part.label);
      if (this.list.children[i] !== row) this.list.insertBefore(row, this.list.children[i] ?? null);
      this.fill(row, part);
    });
  }

  private row(label: number): HTMLLIElement {
    const row = document.createElement("li");
    row.setAttribute("role", "option");
    row.id = `parts-option-${label}`;
    row.dataset.label = String(label);
    const bar = make("meter", { max: this.drawing.top_m || 1 });
    bar.setAttribute("aria-hidden", "true");
    row.append(...["number", "name", "height"].map((className) => make("span", { className })), bar);
    this.rows.set(label, row);
    return row;
  }

  private fill(row: HTMLLIElement, part: Part): void {
    const number = this.numberOf(part.label);
    const texts = [String(number), nameOf(part, number), heightOf(part)];
    texts.forEach((text, i) => row.children[i]!.textContent !== text && (row.children[i]!.textContent = text));
    (row.lastElementChild as HTMLMeterElement).value = part.height_m;
    const chosen = part.label === this.drawing.selected;
    if (row.ariaSelected === String(chosen)) return;
    row.ariaSelected = String(chosen);
    if (chosen) row.scrollIntoView({ block: "nearest" });
  }

  private showPart(part: Part): void {
    if (document.activeElement !== this.name || this.name.dataset.label !== String(part.label)) {
      this.name.value = part.name;
      this.name.dataset.label = String(part.label);
      this.complain(this.name, "");
    }
    const mm = (MM * part.height_m).toFixed(2);
    this.height.value = mm;
    this.height.setAttribute("aria-valuetext", heightOf(part));
    if (document.activeElement !== this.exact) {
      this.exact.value = mm;
      this.complain(this.exact, "");
    }
    this.later.hidden = this.isFelt(part.label);
    const named = part.material ?? "";
    if (![...this.material.options].some((each) => each.value === named)) this.material.add(new Option(named, named));
    this.material.value = named;
    this.showNeighbours();
  }

  showNeighbours(): void {
    const options = this.neighbours.map((each) => new Option(nameOf(each, this.numberOf(each.label)), String(each.label)));
    const value = options.map((each) => each.outerHTML).join("");
    if (this.other.dataset.said === value) return;
    this.other.dataset.said = value;
    this.other.replaceChildren(...(options.length ? options : [new Option(t("noNeighbour"), "")]));
    this.join.disabled = !options.length;
  }

  private set(change: Partial<Part>, gesture = ""): void {
    this.drawing.set(new Map([[this.drawing.selected, change]]), gesture && `${gesture} ${this.drawing.selected}`);
  }

  private rename(): void {
    const name = this.name.value.trim();
    const { parts, selected } = this.drawing;
    const twice = name !== "" && parts.some((each) => each.label !== selected && each.name === name);
    if (this.complain(this.name, twice ? t("nameTwice") : "")) this.set({ name }, "name");
  }

  /** Go to the name of the next part that has none; to the list if there is none, or if this one got none. */
  private nameNext(): void {
    const all = frontToBack(this.drawing.parts);
    const at = all.findIndex(({ label }) => label === this.drawing.selected);
    const next = [...all.slice(at + 1), ...all.slice(0, at)].find(({ name }) => !name);
    if (!next || !all[at]?.name) return this.list.focus();
    this.onSelect(next.label);
  }

  private raise(height_m: number, dragged: boolean): void {
    const top_m = Number(this.exact.max) / MM;
    const fits = height_m >= 0 && height_m <= top_m;
    if (!this.complain(this.exact, fits ? "" : t("tooHigh", { top: this.exact.max }))) return;
    this.dragged = dragged;
    this.set({ height_m, automatic: false }, "height");
  }

  /** End a drag: the list is sorted again. */
  private endDrag(): void {
    this.dragged = false;
    this.drawing.history.endGesture();
    this.show();
  }

  private order(by: number): void {
    this.drawing.order(this.drawing.selected, by);
    this.onReorder();
  }

  private key(event: KeyboardEvent): void {
    const { key, altKey, ctrlKey, shiftKey } = event;
    const all = frontToBack(this.drawing.parts).map((each) => each.label);
    const at = all.indexOf(this.drawing.selected);
    const walk: Record<string, number> = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: all.length - 1 };
    if (altKey && (key === "ArrowUp" || key === "ArrowDown")) this.order(key === "ArrowUp" ? 1 : -1);
    else if (key === "ArrowLeft" || key === "ArrowRight") {
      const step = STEPS_M[ctrlKey ? "coarse" : shiftKey ? "fine" : "usual"];
      this.nudge(key === "ArrowRight" ? step : -step);
    } else if (key in walk) this.onSelect(all[Math.max(0, Math.min(all.length - 1, walk[key]!))]!);
    else if (key === "Enter") this.name.select();
    else return;
    event.preventDefault();
  }

  private nudge(by: number): void {
    const part = this.drawing.part(this.drawing.selected);
    if (!part) return;
    const height = Math.round(1e5 * (part.height_m + by)) / 1e5;
    this.raise(Math.max(0, Math.min(Number(this.exact.max) / MM, height)), false);
    this.onReorder();
  }
}

export function input(id: string, type: string): HTMLInputElement {
  return make("input", { id, type });
}

export function select(id: string): HTMLSelectElement {
  return make("select", { id });
}
