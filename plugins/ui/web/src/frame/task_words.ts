import { words } from "kit/words/words";

/** The tasks of the page. */
export const t = words({
  tasks: ["Tasks", "Aufgaben", "Tâches"],
  picture: ["Picture", "Bild", "Image"],
  parts: ["Parts", "Teile", "Parties"],
  feel: ["Feel", "Fühlen", "Toucher"],
  "hand-on": ["Hand on", "Weitergeben", "Transmettre"],
  advanced: ["Advanced", "Erweitert", "Avancé"],
});
