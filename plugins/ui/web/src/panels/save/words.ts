import { words } from "kit/words/words";

/** Saving of the pipeline file. */
export const t = words({
  title: ["Save the pipeline file", "Pipeline-Datei speichern", "Enregistrer le fichier de pipeline"],
  download: ["Download", "Herunterladen", "Télécharger"],
  save: ["Save", "Speichern", "Enregistrer"],
  path: ["File on this computer", "Datei auf diesem Computer", "Fichier sur cet ordinateur"],
  replace: ["Replace a file of this name", "Eine Datei dieses Namens ersetzen", "Remplacer un fichier de ce nom"],
  saved: ["Saved: {path}", "Gespeichert: {path}", "Enregistré : {path}"],
  failed: ["Not saved: {why}", "Nicht gespeichert: {why}", "Non enregistré : {why}"],
});
