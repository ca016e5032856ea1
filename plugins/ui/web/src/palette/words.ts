import { words } from "kit/words/words";

/** The command palette. */
export const t = words({
  find: ["Find", "Suchen", "Rechercher"],
  title: ["Find a command, a panel, a view or a setting",
    "Befehl, Abschnitt, Ansicht oder Einstellung suchen",
    "Rechercher une commande, un panneau, une vue ou un réglage"],
  results: ["Found", "Gefunden", "Trouvé"],
  none: ["Nothing has this name.", "Nichts heißt so.", "Rien ne porte ce nom."],
  count: ["{count} found", "{count} gefunden", "{count} trouvés"],
  language: ["Language of the page", "Sprache der Seite", "Langue de la page"],
  task: ["Task", "Aufgabe", "Tâche"],
  key: ["Key", "Taste", "Touche"],
  head: ["Header", "Kopf der Seite", "En-tête"],
  show: ["Show", "Zeigen", "Afficher"],
  panel: ["Panel", "Abschnitt", "Panneau"],
});
