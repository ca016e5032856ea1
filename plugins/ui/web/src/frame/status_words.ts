import { words } from "../words/words";

/** What the head of the page says. */
export const t = words({
  starting: ["Starting", "Wird gestartet"],
  nothing: ["Open a picture to begin.", "Öffnen Sie zuerst ein Bild."],
  complaints: ["The pipeline file has errors; they are listed under Advanced.",
    "Die Pipeline-Datei hat Fehler; sie stehen unter „Erweitert“."],
  seen: ["The surface can be seen, not felt yet.", "Die Oberfläche ist zu sehen, noch nicht zu fühlen."],
  lost: ["No answer; trying again.", "Keine Antwort; es wird weiter versucht."],
  back: ["Connected again.", "Wieder verbunden."],
  wrongKey: ["This address belongs to an earlier start. Open the address that `tangible ui` has printed now.",
    "Diese Adresse ist von einem früheren Start. Öffnen Sie die, die `tangible ui` jetzt ausgegeben hat."],
  loadAgain: ["The program was updated. Reload this page.",
    "Das Programm wurde erneuert. Laden Sie diese Seite neu."],
  feeling: ["Feeling: {law}", "Zu fühlen: {law}"],
  making: ["Computing {product} with {method}", "{product} wird mit {method} berechnet"],
  makingPlain: ["Computing {product}", "{product} wird berechnet"],
  makingStopped: ["Computation stopped.", "Die Berechnung wurde abgebrochen."],
  computed: ["Computed: {product}", "Berechnet: {product}"],
  stopped: ["Stopped: no force.", "Angehalten: keine Kraft."],
  ended: ["No force: {why}", "Keine Kraft: {why}"],
  waiting: ["No force; waiting for the device: {why}", "Keine Kraft; das Gerät wird gesucht: {why}"],
  watching: ["Another tab holds the hand.", "Ein anderer Tab führt die Hand."],
  nobody: ["No tab holds the hand. Press on the surface to take it.",
    "Kein Tab führt die Hand. Drücken Sie auf die Oberfläche, um sie zu übernehmen."],
});
