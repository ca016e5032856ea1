import { words } from "../../words/words";

/** Verdicts of preflight and of legibility. */
export const t = words({
  ok: ["ok", "in Ordnung"],
  warn: ["warning", "Warnung"],
  unsafe: ["unsafe", "unsicher"],
  illegible: ["not legible", "nicht lesbar"],
  verdict: ["Verdict", "Urteil"],
  what: ["What was checked", "Was geprüft wurde"],
  stands: ["Found", "Befund"],
  passed: ["Checks that passed ({count})", "Bestandene Prüfungen ({count})"],
  wrong: ["Checks with something to say", "Prüfungen mit Befund"],
  set: ["Set {key} to {value}", "{key} auf {value} setzen"],
});
