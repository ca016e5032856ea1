/** The data cursor below the surface: force, material and height; on demand all values at device, contact and mouse. */
import "./data_cursor.css";
import { button } from "../elements";
import { place, type SurfacePlace } from "./reading";
import { asJson, asText, rows, shortRows, type Row } from "./values";
import type { Page } from "../page";
import { on } from "../shortcuts";
import { t } from "../overlay/words";

type Parts = Pick<Page, "view" | "overlay" | "canvas" | "scene" | "say">;

/** Interval of updates, ms, which can be read. */
const EVERY_MS = 100;

export function dataCursor(page: Parts): void {
  const box = document.createElement("details");
  box.id = "data-cursor";
  const heading = document.createElement("summary");
  heading.textContent = t("allValues");
  const [short, table] = [document.createElement("table"), document.createElement("table")];
  for (const each of [short, table]) each.createTBody();
  short.className = "short";
  short.setAttribute("aria-label", t("cursor"));
  const all = Object.assign(document.createElement("div"), { className: "all" });
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  buttons.append(button(t("copyText"), () => copy(false)), button(t("copyJson"), () => copy(true)));
  all.append(table, buttons);
  box.append(heading, all);
  document.getElementById("strip")!.append(short, box);
  all.hidden = true;
  box.addEventListener("toggle", () => (all.hidden = !box.open));
  page.view.keepFree(all, "right");
  const under = follow(page);
  setInterval(() => {
    if (document.hidden) return;
    fill(short, shortRows(page.overlay.live, under()));
    if (!box.open) return;
    fill(table, rows(page.overlay.live, under()));
    box.classList.toggle("under", covers(all, page));
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

/** Return whether the values cover the contact. */
function covers(box: HTMLElement, { overlay, view, canvas }: Parts): boolean {
  if (!overlay.live?.seen) return false;
  const [x, y] = view.toScreen(overlay.live.contact);
  const [own, whole] = [box.getBoundingClientRect(), canvas.getBoundingClientRect()];
  return x > own.left - whole.left && y > own.top - whole.top;
}

/** Return a function that looks up the surface under the mouse. */
function follow(page: Parts): () => SurfacePlace | null {
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

/** Fill the table, writing only changed cells. */
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
      if (values.length === 1 && table.className !== "short") row.cells[1].colSpan = 3;
    }
    for (const [j, text] of [name, ...values].entries()) if (row.cells[j].textContent !== text) row.cells[j].textContent = text;
  }
}
