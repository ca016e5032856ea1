/** Table of figures by name. */
import { notation } from "kit/words/words";
import { t } from "./words";

export function table(figures: Record<string, number>): HTMLTableElement {
  const tableElement = document.createElement("table");
  const head = tableElement.createTHead().insertRow();
  for (const text of [t("figure"), t("value")]) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    head.append(cell);
  }
  const body = tableElement.createTBody();
  for (const [name, value] of Object.entries(figures)) {
    const row = body.insertRow();
    const title = document.createElement("th");
    title.scope = "row";
    title.textContent = name.replaceAll("_", " ");
    row.append(title);
    row.insertCell().textContent = value === null ? "–" : notation(String(Number(value.toPrecision(4))));
  }
  return tableElement;
}
