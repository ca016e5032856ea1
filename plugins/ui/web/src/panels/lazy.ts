/** A panel whose contents come when it is opened first: the page is there sooner. */
import type { Page } from "../page";
import type { Panel } from "./panel";
import { t } from "../frame/words";

/** load: brings what builds it; where that fails, as without the program, it is tried again when it is opened again. */
export function late(about: Omit<Panel, "build">, load: () => Promise<Panel["build"]>): Panel {
  return { ...about, build };

  function build(page: Page, root: HTMLElement): void {
    const box = root.closest("details")!;
    let begun = false;
    const fill = async (): Promise<void> => {
      if (begun || !box.open) return;
      begun = true;
      try {
        const make = await load();
        root.replaceChildren();
        make(page, root);
      } catch (error) {
        begun = false;
        root.textContent = t("panelFailed", { error: (error as Error).message });
      }
    };
    box.addEventListener("toggle", () => void fill());
    void fill();
  }
}
