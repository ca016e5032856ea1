import { words } from "kit/words/words";

/** Titles of the panels that are loaded when they are opened, and why one cannot be shown. */
export const t = words({
  legible: ["Legible to fingers", "Für Finger lesbar", "Lisible au doigt"],
  description: ["Description", "Beschreibung", "Description"],
  networks: ["Networks", "Netze", "Réseaux"],
  export: ["Export", "Exportieren", "Exporter"],
  failed: ["This panel could not be shown: {error}",
    "Dieser Abschnitt konnte nicht gezeigt werden: {error}",
    "Ce panneau n'a pas pu être affiché : {error}"],
});
