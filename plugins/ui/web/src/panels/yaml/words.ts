import { words } from "kit/words/words";

/** The pipeline file as text. */
export const t = words({
  title: ["Pipeline file", "Pipeline-Datei", "Fichier de pipeline"],
  text: ["The pipeline file on the screen, as YAML", "Die Pipeline-Datei auf dem Bildschirm, als YAML",
    "Le fichier de pipeline à l'écran, en YAML"],
  copy: ["Copy", "Kopieren", "Copier"],
  copied: ["The text is in the clipboard.", "Der Text ist in der Zwischenablage.", "Le texte est dans le presse-papiers."],
  fine: ["No errors.", "Keine Fehler.", "Aucune erreur."],
  wrong: ["{count} errors:", "{count} Beanstandungen:", "{count} erreurs :"],
  wrongOne: ["One error:", "Eine Beanstandung:", "Une erreur :"],
  typing: ["Not applied yet.", "Noch nicht übernommen.", "Pas encore appliqué."],
});
