/** Changes of the document by forms, applied at once if the person chose that. */
import type { Document } from "kit/server/messages";
import type { Page } from "kit/page";
import { isLabels } from "./section";
import type { Plain } from "kit/server/messages";
import { at, type Edit } from "./values";

const KEPT = "apply-at-once";

export class DocumentEditor {
  /** Called with the server's text if an edit is refused. */
  onRefused: (why: string) => void = () => undefined;

  constructor(private page: Pick<Page, "net" | "document">) {}

  /** The setting that changes without a slow stage take effect at once. */
  get apply(): boolean {
    try {
      return localStorage.getItem(KEPT) !== "no";
    } catch {
      return true;
    }
  }

  set apply(wished: boolean) {
    try {
      localStorage.setItem(KEPT, wished ? "yes" : "no");
    } catch {
      return; // without storage the setting lasts as long as the page
    }
  }

  change(edit: Edit): void {
    void this.submit(edit);
  }

  /** Submit an edit; return whether it was accepted. */
  submit(edit: Edit): Promise<boolean> {
    return this.ask("set", { ...expandMaterials(edit, this.page.document) });
  }

  step(which: "undo" | "redo"): void {
    void this.ask(which, {});
  }

  private async ask(name: string, args: Record<string, unknown>): Promise<boolean> {
    try {
      await this.page.net.ask(name, { ...args, apply: this.apply });
      return true;
    } catch (error) {
      this.onRefused((error as Error).message);
      return false;
    }
  }
}

/** Return an edit of materials in short form (`materials: {1: ice}`) with the block expanded first, so that other keys fit. */
export function expandMaterials(edit: Edit, document: Document | null): Edit {
  const labels = at(document?.said, ["materials"]);
  const keys = [...Object.keys(edit.changes ?? {}), ...Object.keys(edit.written ?? {})];
  if (!isLabels(labels) || !keys.some((key) => key.startsWith("materials."))) return edit;
  const { "materials.by": by, ...changes } = edit.changes ?? {};
  return { ...edit, changes: { materials: { by: by ?? (labels as Plain) }, ...changes } };
}
