/** The sentence in the head of the page: one, and true, from the latest facts about connection, work and force. */
import type { Hub } from "kit/hub";
import { productName } from "../words/product_words";
import { t } from "./status_words";

/** Time without an answer after which the head says what to do, ms. */
const LONG_MS = 10_000;

/** The logger that tells, in seconds, how long kernels are compiled; a child of it, how long still. */
const COMPILES = "tangible_core.compiled.compiling";

export type What = "idle" | "busy" | "felt" | "stopped" | "error";

export interface Headline {
  what: What;
  text: string;
}

/** The latest facts; an empty text stands for none. */
export interface Facts {
  connection: "starting" | "open" | "silent" | "lost" | "dead" | "key" | "version";
  /** Why the computing process is gone for good. */
  workerGone: string;
  document: "none" | "opening" | "wrong" | "fine";
  /** The stage that is at work, in words. */
  making: string;
  /** What went wrong last, until something else is begun. */
  trouble: string;
  /** True once a surface is on the screen. */
  seen: boolean;
  /** Force law under the hand. */
  law: string;
  /** Why there is no force, in words. */
  noForce: string;
  hand: "ours" | "free" | "elsewhere";
}

export const FIRST: Facts = {
  connection: "starting", workerGone: "", document: "none", making: "", trouble: "", seen: false, law: "", noForce: "", hand: "ours",
};

/** Return the sentence: the first that applies of connection, force, fault, work, hand and touch. */
export function headline(facts: Facts): Headline {
  const { connection, workerGone, document, making, trouble, seen, law, noForce, hand } = facts;
  if (connection === "key") return { what: "error", text: t("wrongKey") };
  if (connection === "version") return { what: "error", text: t("loadAgain") };
  if (connection === "silent" || connection === "lost" || connection === "dead") return { what: "error", text: t(connection) };
  if (connection === "starting") return { what: "idle", text: t("starting") };
  if (workerGone) return { what: "error", text: workerGone };
  if (noForce) return { what: "stopped", text: making ? `${noForce} ${making}` : noForce };
  if (trouble) return { what: "error", text: trouble };
  if (making) return { what: "busy", text: making };
  if (document === "wrong" && !law) return { what: "error", text: t("complaints") };
  if (hand !== "ours") return { what: "idle", text: t(hand === "free" ? "nobody" : "watching") };
  if (law) return { what: "felt", text: t("feeling", { law }) };
  if (seen) return { what: "idle", text: t("seen") };
  return { what: "idle", text: t(document === "none" ? "nothing" : "starting") };
}

/** Keep the facts by the events of the hub; `changed` is called after each event that may change them. */
export function follow(hub: Hub, changed: (facts: Facts) => void): Facts {
  const facts = { ...FIRST };
  const set = (more: Partial<Facts>): void => changed(Object.assign(facts, more));
  let waiting = 0;
  /** Say what to do if nothing answers for long. */
  const lose = (connection: "silent" | "lost", more: Partial<Facts> = {}): void => {
    if (facts.connection !== "dead") set({ connection, ...more });
    waiting ||= window.setTimeout(() => set({ connection: "dead" }), LONG_MS);
  };
  const find = (): void => {
    clearTimeout(waiting);
    waiting = 0;
    set({ connection: "open" });
  };
  hub.on("hello", find);
  hub.on("gone", () => lose("lost", { making: "" }));
  hub.on("silence", ({ silent }) => (silent ? lose("silent") : find()));
  hub.on("refused", ({ why }) => set({ connection: why }));
  hub.on("maker", () => set({ workerGone: "" }));
  hub.on("maker_gone", ({ why }) => set({ workerGone: why, making: "" }));
  hub.on("document", ({ complaints, path, text }) => {
    set({ document: complaints.length ? "wrong" : path && text ? "fine" : "none", trouble: "" });
  });
  hub.on("opening", ({ name }) => {
    if (facts.document === (name ? "none" : "opening")) set({ document: name ? "opening" : "none" });
  });
  hub.on("making", () => set({ trouble: "" }));
  hub.on("stage", ({ product, method, done }) => {
    const isNews = method !== "core" && !product.endsWith(method); // the method is a choice, and not the product's own name
    if (!done.outcome) set({ making: t(isNews ? "making" : "makingPlain", { product: productName(product), method }) });
  });
  hub.on("log", ({ logger, text }) => {
    const seconds = logger.startsWith(COMPILES) ? /\d+/.exec(text)?.[0] : undefined;
    if (seconds) set({ making: t("preparing", { seconds }) });
  });
  hub.on("made", ({ outcome, why }) => set({ making: "", trouble: outcome === "failed" ? why : "" }));
  hub.on("error", ({ text }) => set({ trouble: text }));
  hub.on("shown", () => set({ seen: true }));
  hub.on("touch", ({ law }) => set({ law, noForce: "", trouble: "" }));
  hub.on("loop", ({ running, stopped, why, waiting }) => {
    set({ noForce: running ? "" : stopped ? t("stopped") : t(waiting ? "waiting" : "ended", { why }) });
  });
  hub.on("holding", ({ holding, free }) => set({ hand: holding ? "ours" : free ? "free" : "elsewhere" }));
  return facts;
}
