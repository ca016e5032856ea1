import { words } from "../../words/words";

/** The signs on the surface. */
export const t = words({
  title: ["What the signs mean", "Was die Zeichen bedeuten"],
  hand: ["your hand, or the point of the device", "Ihre Hand oder die Spitze des Geräts"],
  proxy: ["the point on the surface that follows your hand", "der Punkt auf der Oberfläche, der Ihrer Hand folgt"],
  contact: ["the place that is touched", "die Stelle, die berührt wird"],
  force: ["the force: its direction, and by its length its strength",
    "die Kraft: ihre Richtung und, an der Länge, ihre Stärke"],
});
