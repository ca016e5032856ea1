/** Products of the pipeline: method, outcome, reason and time of each. */
import { make } from "kit/elements";
import type { Page } from "kit/page";
import type { Panel } from "../panel";
import { productName } from "../../words/product_words";
import { t } from "./words";
import { type Row, progressOf, StageTable, type StateOf } from "./table";
import "./stages.css";

const REFRESH_MS = 200;
/** A symbol for each state, next to its word. */
const SHAPES: Record<StateOf, string> = {
  waiting: "○", running: "◐", ran: "●", cached: "◆", given: "▣", skipped: "–", refused: "⊘", failed: "✕", stopped: "■",
};
const PRODUCTS = ["views", "disparity", "relief", "segments", "parts", "simplified", "materials", "surface", "touch"] as const;

function build(page: Page, root: HTMLElement): void {
  const table = new StageTable();
  const list = make("ol", { className: "stages" });
  const empty = make("p", { textContent: t("none") });
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
    table.setPlan(plan);
    show();
  });
  page.hub.on("making", ({ digest }) => {
    table.start(digest);
    ended.textContent = "";
    show();
  });
  page.hub.on("stage", ({ product, method, done }) => {
    table.update(product, method, done, performance.now());
    show();
  });
  page.hub.on("made", ({ want, outcome, why }) => {
    table.end(outcome);
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
  const head = make("div", { className: "head" });
  head.append(
    part("shape", SHAPES[row.state], true),
    part("product", stageName(row.product)),
    part("state", t(row.state)),
    part("time", time(row, performance.now())),
  );
  box.append(head);
  if (row.state === "running") box.append(bar(row));
  const method = row.method === "core" ? "" : row.method;
  if (method || row.why) box.append(text([method, row.why].filter(Boolean).join(": ")));
  for (const { kind, text: value } of row.notes) {
    const note = text(t(kind) + value);
    if (kind !== "decision") note.classList.add("warn");
    box.append(note);
  }
  return box;
}

function bar(row: Row): HTMLElement {
  const progressBar = document.createElement("progress");
  progressBar.setAttribute("aria-label", t("progress", { product: stageName(row.product) }));
  const done = progressOf(row, performance.now());
  if (done !== null) progressBar.value = done;
  return progressBar;
}

/** Update times and bars alone, so that focus and reading position stay. */
function progress(list: HTMLElement, table: StageTable): void {
  const now = performance.now();
  table.rows.forEach((row, at) => {
    if (row.state !== "running") return;
    const box = list.children[at];
    box.querySelector(".time")!.textContent = time(row, now);
    const done = progressOf(row, now);
    const progressBar = box.querySelector("progress");
    if (progressBar && done !== null) progressBar.value = done;
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

function stageName(product: string): string {
  const known = PRODUCTS.find((each) => each === product);
  return known ? t(known) : productName(product);
}

function part(name: string, text: string, hidden = false): HTMLElement {
  const span = make("span", { className: name, textContent: text });
  if (hidden) span.setAttribute("aria-hidden", "true");
  return span;
}

function text(value: string): HTMLElement {
  const status = make("p", { className: "hint", textContent: value });
  return status;
}

export const stages: Panel = { id: "stages", title: t("title"), task: "advanced", open: true, build };
