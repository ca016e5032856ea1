import { words } from "../../words/words";

/** The pipeline file as text. */
export const t = words({
  title: ["Pipeline file", "Pipeline-Datei"],
  text: ["The pipeline file on the screen, as YAML", "Die Pipeline-Datei auf dem Bildschirm, als YAML"],
  copy: ["Copy", "Kopieren"],
  copied: ["The text is in the clipboard.", "Der Text ist in der Zwischenablage."],
  fine: ["No errors.", "Keine Fehler."],
  wrong: ["{count} errors:", "{count} Beanstandungen:"],
  wrongOne: ["One error:", "Eine Beanstandung:"],
  typing: ["Not applied yet.", "Noch nicht übernommen."],
});
