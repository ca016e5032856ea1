import { words } from "kit/words/words";

/** Texts of a participant's page that are its own; questions come from the program. */
export const t = words({
  study: ["Study", "Studie", "Étude"],
  answers: ["Answers", "Antworten", "Réponses"],
  enter: ["Enter", "Eingabetaste", "Entrée"],
  aloud: ["Read aloud (off with a screen reader)", "Vorlesen (aus mit einem Screenreader)",
    "Lire à voix haute (inutile avec un lecteur d'écran)"],
  stop: ["Stop (Esc)", "Halt (Esc)", "Arrêt (Échap)"],
  leave: ["Leave", "Aufhören", "Partir"],
  lost: ["The program does not answer. Ask the experimenter.",
    "Das Programm antwortet nicht. Bitte wenden Sie sich an die Versuchsleitung.",
    "Le programme ne répond pas. Adressez-vous à la personne qui mène l'expérience."],
  pad: ["Surface to feel", "Fläche zum Fühlen", "Surface à toucher"],
  how: ["To feel: slide a finger here, or hold a mouse button. With the keyboard: arrow keys move, Space presses and lifts. A game pad works too.",
    "Zum Fühlen: Fahren Sie hier mit dem Finger, oder halten Sie eine Maustaste gedrückt. Mit der Tastatur: Die Pfeiltasten bewegen, die Leertaste drückt und hebt. Ein Gamepad geht auch.",
    "Pour toucher : glissez un doigt ici, ou maintenez un bouton de la souris. Au clavier : les flèches déplacent, Espace appuie et lève. Une manette convient aussi."],
  touching: ["Touching.", "Berührt.", "Touche."],
  lifted: ["Not touching.", "Berührt nichts.", "Ne touche rien."],
});
