import { words } from "../../words/words";

/** Saving of the pipeline file. */
export const t = words({
  title: ["Save the pipeline file", "Pipeline-Datei speichern"],
  download: ["Download", "Herunterladen"],
  save: ["Save", "Speichern"],
  path: ["File on this computer", "Datei auf diesem Computer"],
  replace: ["Replace a file of this name", "Eine Datei dieses Namens ersetzen"],
  saved: ["Saved: {path}", "Gespeichert: {path}"],
  failed: ["Not saved: {why}", "Nicht gespeichert: {why}"],
});
