import { words } from "../../words/words";

/** What was edited and not saved when the program ended. */
export const t = words({
  left: ["{name} was edited and not saved when the program ended ({when}).",
    "{name} wurde bearbeitet und war nicht gespeichert, als das Programm endete ({when})."],
  open: ["Open it again", "Wieder öffnen"],
  forget: ["Throw it away", "Verwerfen"],
});
