import { words } from "../words/words";

/** Titles of the panels from which the picture is handed on; what is in them comes when they are opened. */
export const t = words({
  legible: ["Legible to fingers", "Für Finger lesbar"],
  description: ["Description", "Beschreibung"],
  export: ["Export", "Weitergeben"],
});
