import { words } from "../words/words";

/** Titles of the panels that are loaded when they are opened, and why one cannot be shown. */
export const t = words({
  legible: ["Legible to fingers", "Für Finger lesbar"],
  description: ["Description", "Beschreibung"],
  export: ["Export", "Exportieren"],
  failed: ["This panel could not be shown: {error}", "Dieser Abschnitt konnte nicht gezeigt werden: {error}"],
});
