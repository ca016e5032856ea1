/** A panel whose module is loaded when it is first seen open, so that the page starts sooner. */
import { onComingOrGoing } from "../frame/tasks";
import type { Page } from "kit/page";
import type { Panel } from "./panel";
import { t } from "./words";

const fillers: (() => Promise<void>)[] = [];

/** Build what is not built yet, seen or not, so that its controls can be found by their names. */
export const fillAll = async (): Promise<void> => void (await Promise.all(fillers.map((fill) => fill())));

/** Return a panel that builds itself from a module when it is first seen open.
 *
 * If loading or building fails, the panel shows why and tries again when it is opened the next time. */
export function lazy(about: Omit<Panel, "build">, load: () => Promise<Pick<Panel, "build">>): Panel {
  return { ...about, build };

  function build(page: Page, root: HTMLElement): void {
    const box = root.closest("details")!;
    let started = false;
    const seen = (): void => void (box.open && box.checkVisibility() && fill());
    const fill = async (): Promise<void> => {
      if (started) return;
      started = true;
      try {
        const panel = await load();
        root.replaceChildren();
        await panel.build(page, root);
      } catch (error) {
        started = false;
        root.textContent = t("failed", { error: (error as Error).message });
      }
    };
    fillers.push(fill);
    onComingOrGoing(box, seen);
    seen();
  }
}
