/** The methods panel: forms of the document; run and stop; undo and redo. */
import { button, make } from "kit/elements";
import { showComplaints } from "../../forms/complaints";
import { DocumentEditor } from "../../forms/editor";
import { SectionForm } from "../../forms/section";
import { sections } from "../../forms/sections";
import type { FileSchema } from "../../forms/schema";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { t } from "../../forms/words";
import { runControls } from "./run_controls";
import "./methods.css";

function build(page: Page, root: HTMLElement): void {
  const editor = new DocumentEditor(page);
  const complaints = make("div", { className: "complaints", tabIndex: -1, hidden: true });
  const forms = make("div", { textContent: t("waiting") });
  let shown: SectionForm[] = [];
  let loading = false;
  const refused = make("p", { className: "bad" });
  refused.setAttribute("role", "status");
  editor.onRefused = (why) => (refused.textContent = why);

  const show = (): void => {
    if (!page.document) return;
    refused.textContent = "";
    if (page.document.said) for (const each of shown) each.show(page.document);
    showComplaints(root, complaints, page.document.complaints);
  };
  const load = async (): Promise<void> => {
    if (shown.length || loading) return;
    loading = true;
    const schema = await page.net.ask<FileSchema>("schema").finally(() => (loading = false));
    shown = sections(schema).map((each) => new SectionForm(each, (edit) => editor.change(edit)));
    forms.replaceChildren(...shown.map((each) => each.root));
    show();
  };

  const compare = make("p", { className: "hint", textContent: t("compare") });
  root.append(runControls(page, editor), refused, complaints, steps(page, editor), forms, compare);
  page.hub.on("document", () => {
    show();
    void page.idle.then(load).catch(() => undefined); // the server loads all methods for their schema
  });
}

function steps(page: Page, editor: DocumentEditor): HTMLElement {
  const box = make("div", { className: "buttons" });
  const undo = button(t("undo"), () => editor.step("undo"));
  const redo = button(t("redo"), () => editor.step("redo"));
  undo.id = "undo";
  redo.id = "redo";
  box.append(undo, redo);
  const able = (): void => {
    undo.setAttribute("aria-disabled", String(!page.document?.can_undo));
    redo.setAttribute("aria-disabled", String(!page.document?.can_redo));
  };
  able();
  page.hub.on("document", able);
  return box;
}

export const methods: Panel = { id: "methods", title: t("title"), task: "advanced", open: true, build };
