import { words } from "../words/words";

/** What is said of the hand and of the surface under it. */
export const t = words({
  nameless: ["surface", "Oberfläche"],
  part: ["{name}, part {part}", "{name}, Teil {part}"],
  touching: ["Touching {what}.", "Berührt: {what}."],
  inTheAir: ["In the air.", "In der Luft."],
  noHand: ["No hand is on the surface.", "Keine Hand ist auf der Oberfläche."],
  nothing: ["There is no surface yet.", "Es gibt noch keine Oberfläche."],
  left: ["{x} millimetres left of the middle", "{x} Millimeter links der Mitte"],
  right: ["{x} millimetres right of the middle", "{x} Millimeter rechts der Mitte"],
  near: ["{y} towards you", "{y} zu Ihnen hin"],
  far: ["{y} away from you", "{y} von Ihnen weg"],
  high: ["{height} high", "{height} hoch"],
  force: ["{force} newtons", "{force} Newton"],
  surface: ["Surface: {name}", "Oberfläche: {name}"],
  shown: ["{name} is shown.", "{name} wird gezeigt."],
  size: ["{name}, {width} by {length} millimetres.", "{name}, {width} mal {length} Millimeter."],
  heights: ["Its heights are from {low} to {high} millimetres.", "Die Höhen reichen von {low} bis {high} Millimeter."],
  keys: ["The arrow keys move the hand, Space presses and lifts. W says where the hand is, D describes the surface, question mark shows all keys, Escape takes all force away.",
    "Die Pfeiltasten bewegen die Hand, die Leertaste drückt und hebt sie. W sagt, wo die Hand ist, D beschreibt die Oberfläche, das Fragezeichen zeigt alle Tasten, Escape nimmt alle Kraft weg."],
  FORCE_LIMITED: ["The force is at its limit.", "Die Kraft ist an ihrer Grenze."],
  STIFFNESS_LIMITED: ["The surface is softer than the law asks, so that it stays stable.",
    "Die Oberfläche ist weicher als verlangt, damit sie stabil bleibt."],
  DAMPED: ["The force is damped, so that it stays stable.", "Die Kraft wird gedämpft, damit sie stabil bleibt."],
  NOT_FINITE: ["The law gives no number here: no force.", "Das Kraftgesetz ergibt hier keine Zahl: keine Kraft."],
  STALE: ["The hand is not heard any more: no force.", "Von der Hand kommt nichts mehr: keine Kraft."],
});
