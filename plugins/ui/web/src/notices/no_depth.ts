/** The notice over the relief of a photograph without depth: it does not have the shape of things. */
import { button } from "kit/elements";
import { bring } from "../frame/tasks";
import type { Page } from "kit/page";
import type { Document } from "kit/server/messages";
import { notice } from "./notice";
import { t } from "./words";

const WAYS = ["byParts", "byPair", "byMap", "byNetwork"] as const;

/** Return what the relief of a photograph is made of in place of depth; null for everything else. */
export function madeOf({ scene_kind, relief_from }: Pick<Document, "scene_kind" | "relief_from">): "edges" | "photograph" | null {
  return scene_kind === "photograph" && (relief_from === "edges" || relief_from === "photograph") ? relief_from : null;
}

export function warnOfNoDepth(page: Pick<Page, "hub" | "say">): void {
  const ways = Object.assign(document.createElement("ul"), { id: "how-to-get-depth", hidden: true });
  ways.append(...WAYS.map((each) => Object.assign(document.createElement("li"), { textContent: t(each) })));
  const how = button(t("how"), () => {
    ways.hidden = !ways.hidden;
    how.ariaExpanded = String(!ways.hidden);
  });
  how.ariaExpanded = "false";
  how.setAttribute("aria-controls", ways.id);
  const dismiss = button("×", () => {
    dismissed = path;
    show();
    document.getElementById("terrain")!.focus();
  });
  dismiss.className = "quiet dismiss";
  dismiss.ariaLabel = t("dismiss");
  const { box, say } = notice("no-depth", button(t("draw"), drawParts), how, dismiss);
  box.append(ways);
  /** Paths of the document, and of the last one of which the notice was closed. */
  let [path, dismissed] = ["", ""];
  let from: "edges" | "photograph" | null = null;
  const show = (): void => void (box.hidden = !from || path === dismissed);
  page.hub.on("document", (document) => {
    path = document.path;
    from = document.text ? madeOf(document) : null;
    show();
    if (box.hidden || !from) return;
    say(t(from), t(`${from}Says`));
    page.say(t(from), { topic: "no depth" });
  });
}

/** Open the editor of the parts. */
function drawParts(): void {
  const edit = document.getElementById("parts-edit")!;
  bring(edit);
  edit.click();
}
