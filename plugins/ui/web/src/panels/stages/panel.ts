/** All products of the pipeline: which method makes each, what became of it, why, and how long it took. */
import type { Page } from "../../page";
import type { Panel } from "../panel";
import { made } from "../../words/product_words";
import { t } from "./words";
import { type Row, share, StageTable, type StateOf } from "./table";
import "./stages.css";

const REFRESH_MS = 200;
/** A shape for each state, beside its word. */
const SHAPES: Record<StateOf, string> = {
  waiting: "○", running: "◐", ran: "●", cached: "◆", given: "▣", skipped: "–", refused: "⊘", failed: "✕", stopped: "■",
};
const PRODUCTS = ["views", "disparity", "relief", "segments", "parts", "simplified", "materials", "surface", "touch"] as const;

function build(page: Page, root: HTMLElement): void {
  const table = new StageTable();
  const list = document.createElement("ol");
  list.className = "stages";
  const empty = document.createElement("p");
  empty.textContent = t("none");
  const ended = document.createElement("p");
  ended.setAttribute("role", "status");
  root.append(empty, ended, list);
  let timer = 0;

  const show = (): void => {
    empty.hidden = table.rows.length > 0;
    list.replaceChildren(...table.rows.map(line));
    const runs = table.rows.some(({ state }) => state === "running");
    if (runs && !timer) timer = window.setInterval(() => progress(list, table), REFRESH_MS);
    if (runs || !timer) return;
    clearInterval(timer);
    timer = 0;
  };
  page.hub.on("plan", (plan) => {
    table.plan(plan);
    show();
  });
  page.hub.on("making", ({ digest }) => {
    table.making(digest);
    ended.textContent = "";
    show();
  });
  page.hub.on("stage", ({ product, method, done }) => {
    table.stage(product, method, done, performance.now());
    show();
  });
  page.hub.on("made", ({ want, outcome, why }) => {
    table.made(outcome);
    ended.className = outcome === "failed" ? "bad" : "";
    if (outcome === "failed") ended.textContent = t("ended", { why });
    else if (outcome === "stopped") ended.textContent = t("endedStopped");
    else ended.textContent = want === "relief" || want === "materials" ? t("onlySeen") : "";
    show();
  });
}

function line(row: Row): HTMLElement {
  const box = document.createElement("li");
  box.dataset.product = row.product;
  box.dataset.state = row.state;
  const head = document.createElement("div");
  head.className = "head";
  head.append(
    part("shape", SHAPES[row.state], true),
    part("product", named(row.product)),
    part("state", t(row.state)),
    part("time", time(row, performance.now())),
  );
  box.append(head);
  if (row.state === "running") box.append(bar(row));
  const method = row.method === "core" ? "" : row.method;
  if (method || row.why) box.append(text([method, row.why].filter(Boolean).join(": ")));
  for (const { kind, text: said } of row.notes) {
    const note = text(t(kind) + said);
    if (kind !== "decision") note.classList.add("warn");
    box.append(note);
  }
  return box;
}

function bar(row: Row): HTMLElement {
  const made = document.createElement("progress");
  made.setAttribute("aria-label", t("progress", { product: named(row.product) }));
  const done = share(row, performance.now());
  if (done !== null) made.value = done;
  return made;
}

/** Times and bars alone change while a stage runs: what has focus or is read stays. */
function progress(list: HTMLElement, table: StageTable): void {
  const now = performance.now();
  table.rows.forEach((row, at) => {
    if (row.state !== "running") return;
    const box = list.children[at];
    box.querySelector(".time")!.textContent = time(row, now);
    const done = share(row, now);
    const made = box.querySelector("progress");
    if (made && done !== null) made.value = done;
  });
}

function time(row: Row, nowMs: number): string {
  const expected = row.expected.toFixed(1);
  if (row.state === "waiting") return row.expected >= 0.1 ? t("about", { seconds: expected }) : "";
  if (row.state === "running") {
    const seconds = ((nowMs - row.beganMs) / 1000).toFixed(1);
    return row.expected ? t("of", { seconds, expected }) : t("seconds", { seconds });
  }
  return row.state === "ran" || row.state === "failed" ? t("seconds", { seconds: row.seconds.toPrecision(2) }) : "";
}

function named(product: string): string {
  const known = PRODUCTS.find((each) => each === product);
  return known ? t(known) : made(product);
}

function part(name: string, said: string, hidden = false): HTMLElement {
  const made = document.createElement("span");
  made.className = name;
  made.textContent = said;
  if (hidden) made.setAttribute("aria-hidden", "true");
  return made;
}

function text(said: string): HTMLElement {
  const made = document.createElement("p");
  made.className = "hint";
  made.lang = "en";
  made.textContent = said;
  return made;
}

export const stages: Panel = { id: "stages", title: t("title"), place: "left", open: true, build };
