/** Native elements, created in one line. */

/** Return a new element with these properties. */
export function make<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Partial<HTMLElementTagNameMap[K]>): HTMLElementTagNameMap[K] {
  return Object.assign(document.createElement(tag), properties);
}

export function button(text: string, press: () => unknown, properties: Partial<HTMLButtonElement> = {}): HTMLButtonElement {
  const toggle = make("button", { type: "button", textContent: text, ...properties });
  toggle.addEventListener("click", () => void press());
  return toggle;
}

/** A control under its name; the control needs an id. */
export function field(name: string, control: HTMLElement): HTMLDivElement {
  const box = document.createElement("div");
  box.className = "field";
  const label = document.createElement("label");
  label.htmlFor = control.id;
  label.textContent = name;
  box.append(label, control);
  return box;
}

/** Return a box that opens and closes, with a heading. */
export function foldable(title: string, ...inside: HTMLElement[]): HTMLDetailsElement {
  const box = document.createElement("details");
  box.append(make("summary", { textContent: title }), ...inside);
  return box;
}

/** Return a label around a control and its text. */
export function labelled(...inside: (Node | string)[]): HTMLLabelElement {
  const label = document.createElement("label");
  label.append(...inside);
  return label;
}

/** Return a group of controls under a name. */
export function fieldset(title: string, ...inside: HTMLElement[]): HTMLFieldSetElement {
  const box = document.createElement("fieldset");
  box.append(make("legend", { textContent: title }), ...inside);
  return box;
}

export function paragraph(text: string, className = ""): HTMLParagraphElement {
  return Object.assign(document.createElement("p"), { className, textContent: text });
}

/** A slider under its name, with its value in words beside the name. The value stands outside of the label: an <output>
 * can be labelled itself, and would take the label, so that the slider had no name. It is for the eyes alone: the
 * slider's own `aria-valuetext` is read. */
export function slider(name: string, control: HTMLInputElement, value: HTMLOutputElement): HTMLDivElement {
  const box = field(name, control);
  box.className = "slider";
  value.ariaHidden = "true";
  box.insertBefore(value, control);
  return box;
}

/** Return a hint under a control, in small letters. */
export function hint(text: string): HTMLParagraphElement {
  return paragraph(text, "hint");
}

/** Return a table with headings and no rows; its title is for screen readers alone. */
export function tableWithHeads(title: string, heads: string[], className: string): HTMLTableElement {
  const table = document.createElement("table");
  table.className = className;
  const caption = table.createCaption();
  caption.className = "visually-hidden";
  caption.textContent = title;
  const row = table.createTHead().insertRow();
  for (const each of heads) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = each;
    row.append(cell);
  }
  return table;
}
