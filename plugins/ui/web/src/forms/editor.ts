/** The one way in which forms change the document: by key, applied at once where that is wished. */
import type { Document } from "../server/messages";
import type { Page } from "../page";
import { isLabels } from "./section";
import type { Plain } from "./schema";
import { at, type Edit } from "./values";

const KEPT = "apply-at-once";

export class Editor {
  /** Refusals, in the server's words. */
  onRefused: (why: string) => void = () => undefined;

  constructor(private page: Page) {}

  /** Whether what needs no slow stage is made and felt as soon as it was edited. */
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
      return; // then it holds for this page's life alone
    }
  }

  change(edit: Edit): void {
    void this.changed(edit);
  }

  /** Whether it was taken. */
  changed(edit: Edit): Promise<boolean> {
    return this.ask("set", { ...spelt(edit, this.page.document) });
  }

  step(which: "undo" | "redo"): void {
    void this.ask(which, {});
  }

  private async ask(name: string, told: Record<string, unknown>): Promise<boolean> {
    try {
      await this.page.net.ask(name, { ...told, apply: this.apply });
      return true;
    } catch (error) {
      this.onRefused((error as Error).message);
      return false;
    }
  }
}

/** A map from label to material in short (`materials: {0: ice}`) has no room for other keys: it is spelt out first. */
export function spelt(edit: Edit, document: Document | null): Edit {
  const labels = at(document?.said, ["materials"]);
  const keys = [...Object.keys(edit.changes ?? {}), ...Object.keys(edit.written ?? {})];
  if (!isLabels(labels) || !keys.some((key) => key.startsWith("materials."))) return edit;
  const { "materials.by": by, ...changes } = edit.changes ?? {};
  return { ...edit, changes: { materials: { by: by ?? (labels as Plain) }, ...changes } };
}
