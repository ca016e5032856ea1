import { words } from "../../words/words";

export const t = words({
  title: ["Preflight", "Sicherheitsprüfung"],
  about: ["Whether this scene, law and device are safe together, and whether what is there will be felt. No device is moved.",
    "Ob Szene, Kraftgesetz und Gerät zusammen sicher sind, und ob zu fühlen sein wird, was da ist. Kein Gerät wird bewegt."],
  check: ["Check now", "Jetzt prüfen"],
  again: ["Check again", "Noch einmal prüfen"],
  checking: ["Checking …", "Prüfung läuft …"],
  stopped: ["The check was stopped.", "Die Prüfung wurde abgebrochen."],
  fix: ["Fix all", "Alles beheben"],
  stale: ["The document changed since this check.", "Seit dieser Prüfung hat sich das Dokument geändert."],
  fixed: ["Changed: {changes}.", "Geändert: {changes}."],
  notFixed: ["No change of the document makes it safe: {sentence}", "Keine Änderung des Dokuments macht es sicher: {sentence}"],
  nothing: ["There is nothing that the document could change.", "Im Dokument gibt es dafür nichts zu ändern."],
  device: ["Judged for the device “{device}” under the law “{law}”.", "Geprüft für das Gerät „{device}“ mit dem Kraftgesetz „{law}“."],
  ownHand: ["Judged for this page's own hand under the law “{law}”: no device is chosen in the document.",
    "Geprüft für die Hand dieser Seite mit dem Kraftgesetz „{law}“: Im Dokument ist kein Gerät gewählt."],
  ofLoop: ["Lateness is that of the force loop, as it runs now.", "Die Verspätung ist die der Kraftschleife, wie sie jetzt läuft."],
  ofMaker: ["Lateness was sampled beside the computing, as no force loop ran long enough: it may be better in use.",
    "Die Verspätung wurde neben der Berechnung gemessen, da keine Kraftschleife lange genug lief: Im Gebrauch kann sie besser sein."],
});
