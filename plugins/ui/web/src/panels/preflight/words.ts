import { words } from "../../words/words";

export const t = words({
  title: ["Preflight", "Sicherheitsprüfung"],
  about: ["Checks whether scene, force law and device are safe together, and whether the relief can be felt. No device moves.",
    "Ob Szene, Kraftgesetz und Gerät zusammen sicher sind, und ob zu fühlen sein wird, was da ist. Kein Gerät wird bewegt."],
  check: ["Check now", "Jetzt prüfen"],
  again: ["Check again", "Noch einmal prüfen"],
  checking: ["Checking …", "Prüfung läuft …"],
  stopped: ["The check was stopped.", "Die Prüfung wurde abgebrochen."],
  fix: ["Fix all", "Alles beheben"],
  stale: ["The document has changed since this check.", "Seit dieser Prüfung hat sich das Dokument geändert."],
  fixed: ["Changed: {changes}.", "Geändert: {changes}."],
  notFixed: ["The document alone cannot make this safe: {sentence}", "Keine Änderung des Dokuments macht es sicher: {sentence}"],
  nothing: ["There is nothing to change in the document for this.", "Im Dokument gibt es dafür nichts zu ändern."],
  device: ["Judged for the device “{device}” with the force law “{law}”.", "Geprüft für das Gerät „{device}“ mit dem Kraftgesetz „{law}“."],
  ownHand: ["Judged for this page's own hand with the force law “{law}”: no device is chosen in the document.",
    "Geprüft für die Hand dieser Seite mit dem Kraftgesetz „{law}“: Im Dokument ist kein Gerät gewählt."],
  ofLoop: ["Lateness is that of the force loop as it runs now.", "Die Verspätung ist die der Kraftschleife, wie sie jetzt läuft."],
  ofMaker: ["Lateness was measured next to the computation, because no force loop ran long enough: in use it may be better.",
    "Die Verspätung wurde neben der Berechnung gemessen, da keine Kraftschleife lange genug lief: Im Gebrauch kann sie besser sein."],
});
