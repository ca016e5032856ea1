/** Figures by name, as a table. */
import { t } from "./words";

export function table(figures: Record<string, number>): HTMLTableElement {
  const made = document.createElement("table");
  const head = made.createTHead().insertRow();
  for (const text of [t("figure"), t("value")]) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    head.append(cell);
  }
  const body = made.createTBody();
  for (const [name, value] of Object.entries(figures)) {
    const row = body.insertRow();
    const title = document.createElement("th");
    title.scope = "row";
    title.textContent = name.replaceAll("_", " ");
    row.append(title);
    row.insertCell().textContent = value === null ? "–" : String(Number(value.toPrecision(4)));
  }
  return made;
}
