import { words } from "kit/words/words";

/** Two force laws on one hand. */
export const t = words({
  title: ["Compare two force laws", "Zwei Kraftgesetze vergleichen", "Comparer deux lois de force"],
  about: [
    "The force law of the pipeline file is called a. Choose another one: you feel one of the two and see the force of the other.",
    "Das Kraftgesetz der Pipeline-Datei heißt a. Wählen Sie ein zweites: Sie fühlen eines davon und sehen die Kraft des anderen.",
    "La loi de force du fichier de pipeline s'appelle a. Choisissez-en une autre : vous sentez l'une des deux et voyez la force de l'autre.",
  ],
  other: ["The other force law, b", "Das andere Gesetz, b", "L'autre loi de force, b"],
  options: ["Its options", "Seine Optionen", "Ses options"],
  optionsHelp: ["As in the file, for example {stiffness_n_per_m: 500}", "Wie in der Datei, zum Beispiel {stiffness_n_per_m: 500}",
    "Comme dans le fichier, par exemple {stiffness_n_per_m: 500}"],
  begin: ["Compare", "Vergleichen", "Comparer"],
  end: ["End the comparison", "Vergleich beenden", "Terminer la comparaison"],
  felt: ["Force law you feel", "Was Sie fühlen", "Loi de force que vous sentez"],
  named: ["{letter}: {law}", "{letter}: {law}", "{letter} : {law}"],
  feeling: ["You feel {letter}: {law}", "Jetzt zu fühlen: {letter}, {law}", "Vous sentez {letter} : {law}"],
  question: ["Question of a blind study", "Frage einer Blindstudie", "Question d'une étude à l'aveugle"],
  same: ["Which of three is not the same as the others?", "Was von dreien ist nicht wie die anderen?",
    "Laquelle des trois n'est pas comme les autres ?"],
  rougher: ["Which of two is rougher?", "Was von zweien ist rauer?", "Laquelle des deux est plus rugueuse ?"],
  higher: ["Which of two is higher?", "Was von zweien ist höher?", "Laquelle des deux est plus haute ?"],
  study: ["Write a blind study of both laws", "Blindstudie beider Gesetze schreiben", "Écrire une étude à l'aveugle des deux lois"],
  studyHelp: [
    "Nobody sees which law acts, not even you; the analysis says how sure the answer is.",
    "Niemand sieht, welches Gesetz wirkt, auch Sie nicht; die Auswertung sagt, wie sicher die Antwort ist.",
    "Personne ne voit quelle loi agit, pas même vous ; l'analyse dit à quel point la réponse est sûre.",
  ],
  studyWritten: ["The study is written: {file}", "Die Studie ist geschrieben: {file}", "L'étude est écrite : {file}"],
  studyHow: [
    "Run it in a terminal, for each participant with another code in place of P1, and then analyse the answers:",
    "Führen Sie sie im Terminal durch, für jede Person mit einem anderen Kürzel statt P1, und werten Sie dann die Antworten aus:",
    "Lancez-la dans un terminal, avec un autre code que P1 pour chaque personne, puis analysez les réponses :",
  ],
  failed: ["That did not work: {why}", "Das ging nicht: {why}", "Cela n'a pas marché : {why}"],
});
