import { words } from "../../words/words";

/** Two force laws on one hand. */
export const t = words({
  title: ["Compare two laws", "Zwei Kraftgesetze vergleichen"],
  about: [
    "The law of the pipeline file is called a. Choose another one: you feel one of them, and see the force of the other.",
    "Das Kraftgesetz der Pipeline-Datei heißt a. Wählen Sie ein zweites: Sie fühlen eines davon und sehen die Kraft des anderen.",
  ],
  other: ["The other law, b", "Das andere Gesetz, b"],
  options: ["Its options", "Seine Optionen"],
  optionsHelp: ["As in the file, for example {stiffness_n_per_m: 500}", "Wie in der Datei, zum Beispiel {stiffness_n_per_m: 500}"],
  begin: ["Compare", "Vergleichen"],
  end: ["End the comparison", "Vergleich beenden"],
  felt: ["What you feel", "Was Sie fühlen"],
  named: ["{letter}: {law}", "{letter}: {law}"],
  feeling: ["Now felt: {letter}, {law}", "Jetzt zu fühlen: {letter}, {law}"],
  question: ["Question of the blind test", "Frage des Blindtests"],
  questionFirst: ["Which feels more like what you see?", "Was fühlt sich eher so an, wie es aussieht?"],
  blind: ["Begin a blind test", "Blindtest beginnen"],
  blindHelp: [
    "The laws are called 1 and 2, drawn anew for each trial. Feel both, then choose.",
    "Die Gesetze heißen 1 und 2, in jedem Durchgang neu verlost. Fühlen Sie beide, dann wählen Sie.",
  ],
  trial: ["Trial {number}: now felt is {called}", "Durchgang {number}: jetzt zu fühlen ist {called}"],
  feel1: ["Feel 1", "1 fühlen"],
  feel2: ["Feel 2", "2 fühlen"],
  choose1: ["1 it is", "Es ist 1"],
  choose2: ["2 it is", "Es ist 2"],
  chooseNone: ["No difference", "Kein Unterschied"],
  reveal: ["End the test and say which was which", "Test beenden und auflösen"],
  result: ["{law}: chosen {count} times", "{law}: {count}-mal gewählt"],
  neither: ["No difference: {count} times", "Kein Unterschied: {count}-mal"],
  chance: [
    "Who feels no difference chooses at least this one-sidedly in {percent} % of such tests.",
    "Wer keinen Unterschied fühlt, wählt in {percent} % solcher Tests mindestens so einseitig.",
  ],
  kept: ["Kept in {path}", "Gespeichert in {path}"],
  failed: ["It did not work: {why}", "Das ging nicht: {why}"],
});
