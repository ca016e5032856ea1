/** Native elements, made in one line. */

export function button(text: string, press: () => unknown): HTMLButtonElement {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.addEventListener("click", () => void press());
  return made;
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
