import { words } from "../words/words";

/** Texts of a participant's page that are its own; questions come from the program. */
export const t = words({
  study: ["Study", "Studie"],
  answers: ["Answers", "Antworten"],
  enter: ["Enter", "Eingabetaste"],
  aloud: ["Read aloud (off with a screen reader)", "Vorlesen (aus mit einem Screenreader)"],
  stop: ["Stop (Esc)", "Halt (Esc)"],
  leave: ["Leave", "Aufhören"],
  lost: ["The program does not answer. Ask the experimenter.",
    "Das Programm antwortet nicht. Bitte wenden Sie sich an die Versuchsleitung."],
  pad: ["Surface to feel", "Fläche zum Fühlen"],
  how: ["To feel: slide a finger here, or hold a mouse button. With the keyboard: arrow keys move, Space presses and lifts. A game pad works too.",
    "Zum Fühlen: Fahren Sie hier mit dem Finger, oder halten Sie eine Maustaste gedrückt. Mit der Tastatur: Die Pfeiltasten bewegen, die Leertaste drückt und hebt. Ein Gamepad geht auch."],
  touching: ["Touching.", "Berührt."],
  lifted: ["Not touching.", "Berührt nichts."],
});
