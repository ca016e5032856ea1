/** A dialog with a question, answered by a button; Escape is the first answer, which changes nothing. */
import { button, make } from "kit/elements";

export function question<T extends string>(title: string, texts: string[], answers: readonly (readonly [T, string])[]): Promise<T> {
  const dialog = make("dialog", { className: "sure" });
  const heading = make("h2", { id: "parts-question", textContent: title });
  dialog.setAttribute("aria-labelledby", heading.id);
  const status = texts.map((text) => make("p", { textContent: text }));
  const buttons = make("div", { className: "buttons" });
  buttons.append(...answers.map(([answer, text]) => button(text, () => dialog.close(answer))));
  (buttons.firstElementChild as HTMLElement).autofocus = true;
  dialog.append(heading, ...status, buttons);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((done) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      done((dialog.returnValue || answers[0]![0]) as T);
    });
  });
}
