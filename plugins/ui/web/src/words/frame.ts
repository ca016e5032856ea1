import { words } from "./words";

/** The page's frame: what stands around the panels. */
export const t = words({
  title: ["Tangible Images", "Tangible Images"],
  starting: ["starting", "wird gestartet"],
  stop: ["Stop: no force", "Stopp: keine Kraft"],
  feelAgain: ["Feel again", "Wieder fühlen"],
  stopped: ["Stopped: no force.", "Angehalten: keine Kraft."],
  gone: ["The program is not there any more. Start `tangible ui` again; this page then goes on.",
    "Das Programm ist nicht mehr da. Starten Sie `tangible ui` wieder; dann geht es auf dieser Seite weiter."],
  feeling: ["Feeling: {law}", "Zu fühlen: {law}"],
  making: ["{product} is being made by {method}", "{product} wird mit {method} berechnet"],
  watching: ["Another tab holds the hand.", "Ein anderer Tab führt die Hand."],
  takeHand: ["Take the hand", "Die Hand übernehmen"],
  language: ["Language", "Sprache"],
  terrain: ["Terrain", "Gelände"],
});
