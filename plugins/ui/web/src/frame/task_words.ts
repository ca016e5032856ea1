import { words } from "kit/words/words";

/** The tasks of the page. */
export const t = words({
  tasks: ["Tasks", "Aufgaben", "Tâches"],
  picture: ["Picture", "Bild", "Image"],
  parts: ["Parts", "Teile", "Parties"],
  feel: ["Feel", "Fühlen", "Toucher"],
  "hand-on": ["Export", "Exportieren", "Exporter"],
  advanced: ["Advanced", "Erweitert", "Avancé"],
});
