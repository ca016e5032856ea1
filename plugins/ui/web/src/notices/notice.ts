/** A notice over the surface: a sentence, and what can be done about it. */
import "./notice.css";

/** Return a hidden notice, added above the surface. */
export function notice(id: string, ...buttons: HTMLButtonElement[]): { box: HTMLElement; say(first: string, more?: string): void } {
  const box = Object.assign(document.createElement("div"), { id, className: "notice", hidden: true });
  const text = document.createElement("p");
  const row = Object.assign(document.createElement("div"), { className: "buttons" });
  row.append(...buttons);
  box.append(text, row);
  document.getElementById("notices")!.append(box);
  const say = (first: string, more = ""): void => {
    const rest = Object.assign(document.createElement("span"), { textContent: more && ` ${more}` });
    text.replaceChildren(Object.assign(document.createElement("strong"), { textContent: first }), rest);
  };
  return { box, say };
}
