/** The progress of an export: file by file, with the product that is made for it. */
import { make } from "kit/elements";
import type { Page } from "kit/page";
import { productName } from "../../words/product_words";
import { exporterName } from "./choices";
import { t } from "./words";

const EXPORT = "export: ";
/** Share of what is left of a file that each of its products takes: how many there will be is not known. */
const STEP = 0.3;

/** How far an export of several files is. */
export class Steps {
  private finished = 0;
  private left = 1;

  constructor(private names: string[]) {}

  get total(): number {
    return this.names.length;
  }

  /** Files that are done, and the share of the present one. */
  get value(): number {
    return Math.min(this.total, this.finished + (1 - this.left));
  }

  /** Take a product that was begun or finished; return what is made now, in words. */
  take(product: string, finished: boolean): string {
    const file = product.startsWith(EXPORT);
    if (finished && file) [this.finished, this.left] = [this.finished + 1, 1];
    else if (finished) this.left *= 1 - STEP;
    const use = this.names[Math.min(this.finished, this.total - 1)] ?? "";
    const values = { name: exporterName(use), number: Math.min(this.finished + 1, this.total), total: this.total };
    return file || finished ? t("makingFile", values) : t("making", { ...values, product: productName(product) });
  }
}

/** Return the progress. It is not spoken: the status line says start and end. names: of the exporters that run. */
export function progress(page: Page, names: () => string[]): HTMLElement {
  const box = make("p", { className: "hint progress", hidden: true });
  const bar = document.createElement("progress");
  bar.setAttribute("aria-label", t("running"));
  const text = document.createElement("span");
  box.append(bar, text);
  let steps = new Steps([]);
  page.hub.on("making", ({ want }) => {
    box.hidden = want !== "export";
    steps = new Steps(names());
    bar.max = Math.max(1, steps.total);
    bar.value = 0;
    text.textContent = "";
  });
  page.hub.on("stage", ({ product, done }) => {
    if (box.hidden) return; // something else is made
    text.textContent = steps.take(product, !!done.outcome);
    bar.value = steps.value;
  });
  for (const name of ["made", "gone"] as const) page.hub.on(name, () => (box.hidden = true));
  return box;
}
