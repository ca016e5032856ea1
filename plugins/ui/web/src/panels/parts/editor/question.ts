/** A question that is answered with one of its buttons; Escape is the first of them, which changes nothing. */
import { button } from "../../../elements";

export function question<T extends string>(title: string, texts: string[], answers: readonly (readonly [T, string])[]): Promise<T> {
  const dialog = document.createElement("dialog");
  dialog.className = "sure";
  const heading = Object.assign(document.createElement("h2"), { id: "parts-question", textContent: title });
  dialog.setAttribute("aria-labelledby", heading.id);
  const said = texts.map((text) => Object.assign(document.createElement("p"), { textContent: text }));
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(...answers.map(([answer, text]) => button(text, () => dialog.close(answer))));
  (buttons.firstElementChild as HTMLElement).autofocus = true;
  dialog.append(heading, ...said, buttons);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((done) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      done((dialog.returnValue || answers[0]![0]) as T);
    });
  });
}
