/** Pictures of the files before they are written: the page that will be swollen, the print, the pins. */
import { make, paragraph } from "kit/elements";
import type { Page } from "kit/page";
import { token } from "kit/server/token";
import { isMap } from "../../forms/values";
import type { Plain } from "kit/server/messages";
import { decimal, language } from "kit/words/words";
import { exporterName } from "./choices";
import { t } from "./words";

/** Rest after a change before pictures are drawn, ms: a number is typed digit by digit. */
const REST_MS = 400;

interface Preview {
  file: string;
  waits: boolean;
  columns: number;
  rows: number;
  width_m: number;
}

export class Previews {
  readonly root = document.createElement("div");
  private wanted: Plain[] = [];
  private round = 0;
  private timer = 0;
  private stale = true;

  constructor(private page: Pick<Page, "net">) {
    this.root.className = "previews";
    this.root.setAttribute("role", "group");
    this.root.setAttribute("aria-label", t("previews"));
    new IntersectionObserver(() => this.stale && this.begin()).observe(this.root);
  }

  /** Draw these exporters once nothing has changed for a moment; only while the panel is seen. */
  show(blocks: Plain[]): void {
    this.wanted = blocks;
    this.stale = true;
    this.root.classList.toggle("stale", this.root.childElementCount > 0);
    this.begin();
  }

  private begin(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.root.checkVisibility() && void this.draw(), REST_MS);
  }

  private async draw(): Promise<void> {
    const round = ++this.round;
    this.stale = false;
    const drawn: HTMLElement[] = [];
    for (const block of this.wanted) {
      const name = exporterName(String(isMap(block) ? block.use : block));
      const found = await this.page.net.ask<Preview>("export_preview", { block, language }).then(
        (preview) => picture(name, preview),
        (error: Error) => (error.name === "AbortError" ? null : refusal(name, error.message)),
      );
      if (round !== this.round) return; // a newer choice is drawn
      if (found) drawn.push(found);
      this.root.replaceChildren(...drawn);
    }
    this.root.replaceChildren(...drawn);
    this.root.classList.toggle("stale", this.stale); // of a choice that was made meanwhile, they still are
  }
}

function picture(name: string, { file, waits, columns, rows, width_m }: Preview): HTMLElement | null {
  if (waits) return refusal(name, t("previewWaits"));
  if (!file) return null;
  const box = document.createElement("figure");
  const image = new Image(columns, rows);
  image.src = `/scene/${file}?token=${encodeURIComponent(token)}`;
  image.alt = t("previewOf", { name });
  const caption = make("figcaption", { textContent: t("previewSize", { name, width: decimal(100 * width_m, 1) }) });
  box.append(image, caption);
  return box;
}

function refusal(name: string, why: string): HTMLElement {
  const box = document.createElement("figure");
  const text = paragraph(why, "hint warn");
  const caption = make("figcaption", { textContent: name });
  box.append(text, caption);
  return box;
}
