import { words } from "../words/words";

/** The command palette. */
export const t = words({
  find: ["Find", "Suchen"],
  title: ["Find a command, a panel, a view or a setting", "Befehl, Abschnitt, Ansicht oder Einstellung suchen"],
  results: ["Found", "Gefunden"],
  none: ["Nothing has this name.", "Nichts heißt so."],
  count: ["{count} found", "{count} gefunden"],
  task: ["Task", "Aufgabe"],
  key: ["Key", "Taste"],
  head: ["Header", "Kopf der Seite"],
  show: ["Show", "Zeigen"],
  panel: ["Panel", "Abschnitt"],
});
