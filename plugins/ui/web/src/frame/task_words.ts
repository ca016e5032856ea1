import { words } from "../words/words";

/** The tasks of the page. */
export const t = words({
  tasks: ["Tasks", "Aufgaben"],
  picture: ["Picture", "Bild"],
  parts: ["Parts", "Teile"],
  feel: ["Feel", "Fühlen"],
  "hand-on": ["Hand on", "Weitergeben"],
  advanced: ["Advanced", "Erweitert"],
});
