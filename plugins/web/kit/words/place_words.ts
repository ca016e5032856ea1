import { words } from "./words";

const t = words({
  place00: ["upper left", "oben links", "en haut à gauche"],
  place10: ["top", "oben", "en haut"],
  place20: ["upper right", "oben rechts", "en haut à droite"],
  place01: ["left", "links", "à gauche"],
  place11: ["in the middle", "in der Mitte", "au milieu"],
  place21: ["right", "rechts", "à droite"],
  place02: ["lower left", "unten links", "en bas à gauche"],
  place12: ["bottom", "unten", "en bas"],
  place22: ["lower right", "unten rechts", "en bas à droite"],
});

/** Return the ninth of the picture that contains a place: shares of its width from the left, of its length from the top. */
export function ninthOfPicture(x: number, y: number): string {
  const third = (share: number): number => Math.max(0, Math.min(2, Math.floor(3 * share)));
  return t(`place${third(x)}${third(y)}` as Parameters<typeof t>[0]);
}
