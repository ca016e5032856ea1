/** Save the pipeline file on this computer, or download it. */
import { button, field, labelled, make } from "kit/elements";
import { download } from "../../files";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "./words";

function build(page: Page, root: HTMLElement): void {
  const status = make("p", { className: "told" });
  const say = (text: string): void => {
    status.textContent = text;
    page.say(text);
  };
  const path = make("input", { id: "save-path", spellcheck: false });
  const instead = make("input", { type: "checkbox", id: "save-replace" });
  const replace = labelled(instead, t("replace"));
  const save = async (): Promise<void> => {
    try {
      await page.net.ask("save", { path: path.value, replace: instead.checked });
      say(t("saved", { path: page.document?.path ?? path.value }));
    } catch (error) {
      say(t("failed", { why: (error as Error).message }));
    }
  };
  const name = (): string => path.value.split(/[/\\]/).at(-1) || "pipeline.yaml";
  const buttons = make("div", { className: "buttons" });
  const first = button(t("save"), save, { className: "primary" });
  buttons.append(first, button(t("download"), () => download(page.document?.text ?? "", name(), "application/yaml")));
  page.hub.on("document", (message) => {
    path.value ||= message.path;
    if (document.activeElement !== path) path.value = message.path;
  });
  root.append(field(t("path"), path), replace, buttons, status);
}

export const save: Panel = { id: "save", title: t("title"), task: "hand-on", open: true, build };
