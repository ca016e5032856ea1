/** The notice that a pipeline file has errors, in place of a surface that it cannot give. */
import { button } from "kit/elements";
import type { Page } from "kit/page";
import { reveal } from "../panels/panel";
import { notice } from "./notice";
import { t } from "./words";

export function reportWrongFile(page: Pick<Page, "hub" | "scene">): void {
  const { box, say } = notice("wrong-file", button(t("showErrors"), () => reveal("yaml")));
  page.hub.on("document", ({ complaints: [first, ...others] }) => {
    box.hidden = !first || page.scene !== null;
    if (!first) return;
    const place = first.line === null ? "" : t("line", { line: first.line });
    const rest = others.length ? ` ${t("moreErrors", { count: others.length })}` : "";
    say(t("wrongFile"), `${place}${first.text}.${rest}`);
  });
  page.hub.on("shown", () => (box.hidden = true));
}
