/** The data cursor at the lower right of the surface: what is where the device, the contact and the mouse are. */
import "./data_cursor.css";
import { button } from "../elements";
import { place, type Place } from "./reading";
import { asJson, asText, rows, type Row } from "./values";
import type { Page } from "../page";
import { on } from "../shortcuts";
import { t } from "../overlay/words";

/** Ten times a second can be read, and costs nothing. */
const EVERY_MS = 100;
/** A surface so high has room for it. */
const ROOMY_PX = 540;

export function dataCursor(page: Page): void {
  const box = document.createElement("details");
  box.id = "data-cursor";
  box.open = innerWidth >= 768 && page.canvas.clientHeight >= ROOMY_PX; // elsewhere it would cover the surface
  const heading = document.createElement("summary");
  heading.textContent = t("cursor");
  const table = document.createElement("table");
  table.createTBody();
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(button(t("copyText"), () => copy(false)), button(t("copyJson"), () => copy(true)));
  box.append(heading, table, buttons);
  page.canvas.parentElement!.append(box);
  const under = follow(page);
  setInterval(() => {
    if (document.hidden) return;
    if (box.open) fill(table, rows(page.overlay.live, under()));
    box.classList.toggle("under", covers(box, page));
  }, EVERY_MS);
  on("copy values", () => void copy(false));
  on("copy values as JSON", () => void copy(true));

  async function copy(json: boolean): Promise<void> {
    const { live } = page.overlay;
    try {
      await navigator.clipboard.writeText(json ? asJson(live, under()) : asText(rows(live, under())));
      page.say(t("copied"));
    } catch {
      page.say(t("notCopied"));
    }
  }
}

/** Whether the contact lies behind it. */
function covers(box: HTMLElement, { overlay, view, canvas }: Page): boolean {
  if (!overlay.live?.seen) return false;
  const [x, y] = view.toScreen(overlay.live.contact);
  return x > box.offsetLeft - canvas.offsetLeft && y > box.offsetTop - canvas.offsetTop;
}

/** The place on the surface under the mouse, looked up when it is asked for and the mouse or the view has moved. */
function follow(page: Page): () => Place | null {
  const { canvas, view } = page;
  let mouse: [number, number] | null = null;
  canvas.parentElement!.addEventListener("pointermove", (event) => {
    mouse = event.target === canvas ? [event.clientX, event.clientY] : null;
  }, { capture: true, passive: true });
  canvas.addEventListener("pointerleave", () => (mouse = null));
  return () => {
    const { scene } = page;
    const at = scene && mouse && scene.pick(...view.ray(...mouse));
    return scene && at ? place(scene, at[0], at[1]) : null;
  };
}

/** Only what changed is written. */
function fill(table: HTMLTableElement, wanted: Row[]): void {
  const body = table.tBodies[0];
  while (body.rows.length > wanted.length) body.deleteRow(-1);
  for (const [i, [name, ...values]] of wanted.entries()) {
    const row = body.rows[i] ?? body.insertRow();
    const cells = [...row.cells];
    if (cells.length !== 1 + values.length) {
      const heading = document.createElement("th");
      heading.scope = "row";
      row.replaceChildren(heading, ...values.map(() => document.createElement("td")));
      if (values.length === 1) row.cells[1].colSpan = 3;
    }
    for (const [j, text] of [name, ...values].entries()) if (row.cells[j].textContent !== text) row.cells[j].textContent = text;
  }
}
