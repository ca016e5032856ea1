import { words } from "../../words/words";

/** The pipeline file as text. */
export const t = words({
  title: ["Pipeline file", "Pipeline-Datei"],
  text: ["The pipeline file on the screen, as YAML", "Die Pipeline-Datei auf dem Bildschirm, als YAML"],
  copy: ["Copy", "Kopieren"],
  copied: ["The text is in the clipboard.", "Der Text ist in der Zwischenablage."],
  download: ["Download", "Herunterladen"],
  save: ["Save", "Speichern"],
  path: ["File on this computer", "Datei auf diesem Computer"],
  replace: ["Replace the file", "Datei ersetzen"],
  saved: ["Saved: {path}", "Gespeichert: {path}"],
  failed: ["It was not saved: {why}", "Nicht gespeichert: {why}"],
  fine: ["Nothing is wrong with it.", "Daran ist nichts falsch."],
  wrong: ["{count} complaints:", "{count} Beanstandungen:"],
  wrongOne: ["One complaint:", "Eine Beanstandung:"],
  typing: ["Not taken over yet.", "Noch nicht übernommen."],
});
