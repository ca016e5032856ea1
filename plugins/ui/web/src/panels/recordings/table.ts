/** Table of figures by name. */
import { make } from "kit/elements";
import { notation } from "kit/words/words";
import { t } from "./words";

export function table(figures: Record<string, number>): HTMLTableElement {
  const tableElement = document.createElement("table");
  const head = tableElement.createTHead().insertRow();
  for (const text of [t("figure"), t("value")]) {
    const cell = make("th", { scope: "col", textContent: text });
    head.append(cell);
  }
  const body = tableElement.createTBody();
  for (const [name, value] of Object.entries(figures)) {
    const row = body.insertRow();
    const title = make("th", { scope: "row", textContent: name.replaceAll("_", " ") });
    row.append(title);
    row.insertCell().textContent = value === null ? "–" : notation(String(Number(value.toPrecision(4))));
  }
  return tableElement;
}
