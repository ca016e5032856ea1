/** Dialog that asks before a device with a motor is started, and says what will happen. */
import { button, make } from "kit/elements";
import { t } from "./words";

export interface About {
  name: string;
  simulated: boolean;
  most_force_n: number;
  relief_m: number;
}

/** Return whether the person agreed; "no" has the focus first, and anything else means no. */
export function confirmStart(about: About): Promise<boolean> {
  const dialog = make("dialog", { className: "sure" });
  const heading = make("h2", { id: "sure-title", textContent: t("sureTitle", { name: about.name }) });
  dialog.setAttribute("aria-labelledby", heading.id);
  const value = [
    t("sure"),
    t("sureForce", { force: about.most_force_n.toFixed(1) }),
    t("sureRelief", { relief: (1000 * about.relief_m).toFixed(0) }),
  ].join(" ");
  const texts = [value, t("sureHands")].map((text) => make("p", { textContent: text }));
  const buttons = make("div", { className: "buttons" });
  const no = button(t("no"), () => dialog.close(), { autofocus: true });
  const yes = button(t("yes"), () => dialog.close("yes"), { id: "sure-yes" });
  buttons.append(no, yes);
  dialog.append(heading, ...texts, buttons);
  document.body.append(dialog);
  dialog.showModal();
  return new Promise((done) => {
    dialog.addEventListener("close", () => {
      dialog.remove();
      done(dialog.returnValue === "yes");
    });
  });
}
