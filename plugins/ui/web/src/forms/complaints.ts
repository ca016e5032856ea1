/** Complaints of the document's check: at their fields, and as a list that leads there. */
import { button } from "kit/elements";
import type { Complaint } from "kit/server/messages";
import { t } from "./words";
import { FIELD } from "./rows";

/** Return the field of a complaint: of its key, or of the enclosing one. Null if no form has it. */
export function fieldOf({ location }: Complaint, isThere: (id: string) => boolean): string | null {
  for (let depth = location.length; depth > 0; depth--) {
    const id = FIELD + location.slice(0, depth).filter((part, at) => !(at === 1 && part === "use")).join(".");
    if (isThere(id)) return id;
  }
  return null;
}

/** Mark fields and list all complaints; earlier marks are removed. */
export function showComplaints(root: HTMLElement, list: HTMLElement, complaints: Complaint[]): void {
  clear(root);
  const found = complaints.map((each) => ({ each, id: fieldOf(each, (id) => document.getElementById(id) !== null) }));
  const byField = new Map<string, string[]>();
  for (const { each, id } of found) if (id) byField.set(id, [...(byField.get(id) ?? []), each.text]);
  for (const [id, texts] of byField) mark(id, texts.join(" "));
  list.hidden = !complaints.length;
  const heading = document.createElement("p");
  heading.textContent = complaints.length === 1 ? t("complaint") : t("complaints", { count: complaints.length });
  const lines = document.createElement("ul");
  for (const { each, id } of found) {
    const line = document.createElement("li");
    line.append(id ? button(withKey(each), () => focusField(id)) : withLine(each));
    lines.append(line);
  }
  list.replaceChildren(heading, lines);
}

/** Open the foldings around a field and focus it. */
export function focusField(id: string): void {
  const field = document.getElementById(id);
  for (let box = field?.parentElement; box; box = box.parentElement) if (box instanceof HTMLDetailsElement) box.open = true;
  field?.focus();
  field?.scrollIntoView({ block: "center" });
}

function withLine(complaint: Complaint): string {
  const { line } = complaint;
  return line === null ? withKey(complaint) : `${withKey(complaint)} (${t("line", { line })})`;
}

/** Return the complaint with its key in front, once. */
function withKey({ location, text }: Complaint): string {
  const where = location.length ? `${location.join(".")}: ` : "";
  return text.startsWith(where) ? text : where + text;
}

function mark(id: string, text: string): void {
  const field = document.getElementById(id)!;
  field.setAttribute("aria-invalid", "true");
  const complaint = document.getElementById(`${id}-complaint`);
  if (!complaint) return;
  complaint.textContent = text;
  complaint.hidden = false;
}

function clear(root: HTMLElement): void {
  for (const each of root.querySelectorAll("[aria-invalid]")) each.removeAttribute("aria-invalid");
  for (const each of root.querySelectorAll<HTMLElement>(".complaint")) {
    each.hidden = true;
    each.textContent = "";
  }
}
