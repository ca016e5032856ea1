/** The notice that the touch is older than the file, where it is not made again by itself. */
import { button } from "kit/elements";
import { DocumentEditor } from "../forms/editor";
import type { Page } from "kit/page";
import { notice } from "./notice";
import { t } from "./words";

export function offerToMake(page: Pick<Page, "hub" | "net" | "document" | "say">): void {
  const editor = new DocumentEditor(page);
  const make = button(t("make"), () => page.net.ask("make", { want: "touch" }).catch((error: Error) => page.say(error.message)));
  make.className = "primary";
  const { box, say } = notice("pending", make, button(t("undo"), () => editor.step("undo")));
  say(t("pending"));
  let made = "";
  let busy = false;
  let waits = false;
  const show = (): void => void (box.hidden = busy || !waits || !made || page.document?.digest === made);
  page.hub.on("plan", ({ slow }) => {
    waits = slow.length > 0 || !editor.apply;
    show();
  });
  page.hub.on("making", () => {
    busy = true;
    show();
  });
  page.hub.on("made", ({ want, outcome, digest }) => {
    busy = false;
    if (outcome === "made" && want === "touch") made = digest;
    show();
  });
  page.hub.on("document", show);
  page.hub.on("gone", () => (busy = false));
}
