import { words } from "./words";

const t = words({
  place00: ["upper left", "oben links"],
  place10: ["top", "oben"],
  place20: ["upper right", "oben rechts"],
  place01: ["left", "links"],
  place11: ["in the middle", "in der Mitte"],
  place21: ["right", "rechts"],
  place02: ["lower left", "unten links"],
  place12: ["bottom", "unten"],
  place22: ["lower right", "unten rechts"],
});

/** In which ninth of the picture a place is; shares of its width from the left, of its length from the top. */
export function ninth(x: number, y: number): string {
  const third = (share: number): number => Math.max(0, Math.min(2, Math.floor(3 * share)));
  return t(`place${third(x)}${third(y)}` as Parameters<typeof t>[0]);
}
