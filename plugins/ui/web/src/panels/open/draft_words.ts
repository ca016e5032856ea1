import { words } from "kit/words/words";

/** Texts of the offer of unsaved edits. */
export const t = words({
  left: ["{name} was edited and not saved when the program ended ({when}).",
    "{name} wurde bearbeitet und war nicht gespeichert, als das Programm endete ({when}).",
    "{name} était modifié et non enregistré quand le programme s'est terminé ({when})."],
  open: ["Open it again", "Wieder öffnen", "Le rouvrir"],
  forget: ["Discard it", "Verwerfen", "L'abandonner"],
});
