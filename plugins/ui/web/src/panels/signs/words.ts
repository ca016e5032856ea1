import { words } from "kit/words/words";

/** The signs on the surface. */
export const t = words({
  title: ["What the signs mean", "Was die Zeichen bedeuten", "Ce que signifient les signes"],
  hand: ["your hand, or the point of the device",
    "Ihre Hand oder die Spitze des Geräts",
    "votre main, ou la pointe de l'appareil"],
  proxy: ["the point on the surface that follows your hand",
    "der Punkt auf der Oberfläche, der Ihrer Hand folgt",
    "le point de la surface qui suit votre main"],
  contact: ["the place that is touched", "die Stelle, die berührt wird", "l'endroit touché"],
  force: ["the force: its direction, and by its length its strength",
    "die Kraft: ihre Richtung und, an der Länge, ihre Stärke",
    "la force : sa direction, et par sa longueur son intensité"],
});
