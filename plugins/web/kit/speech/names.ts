/** Names of parts and materials, and heights, in words. */
import type { Events } from "../server/messages";
import type { Page } from "../page";
import type { Scene } from "../surface/scene";
import { ninthOfPicture } from "../words/place_words";
import { materialWord } from "../words/material_words";
import { shownNumber } from "../words/part_words";
import { language } from "../words/words";
import type { PartFacts } from "./part_facts";
import { millimetres } from "./telling";
import { t } from "./words";

/** Return "door, wood" or "wood, part 4"; the material alone if there is one part. */
export function describePlace(name: string | undefined, called: string, part: number | null, parts: number): string {
  const text = name === undefined ? t("nameless") : materialWord(name);
  if (called) return name === undefined ? called : `${called}, ${text}`;
  return part === null || parts < 2 ? text : t("part", { name: text, part: shownNumber(part) });
}

/** The names of what lies on a surface. */
export class Names {
  private described: Events["described"] | null = null;

  constructor(hub: Page["hub"], onDescribed: () => void) {
    hub.on("described", (message) => {
      this.described = message;
      onDescribed();
    });
  }

  /** Return part and material of a place. */
  ofPlace(scene: Scene, x: number, y: number): string {
    const material = scene.material(x, y)?.name;
    return describePlace(material, scene.part(x, y), scene.label(x, y), scene.meta.labels);
  }

  /** Return name, place, height and material of a part. */
  ofPart(scene: Scene, { label, at, heightM }: PartFacts): string {
    const [w, l] = scene.meta.extent_m;
    const material = scene.material(...at)?.name;
    return [
      scene.part(...at) || t("partAlone", { number: shownNumber(label) }),
      ninthOfPicture(at[0] / w + 0.5, 0.5 - at[1] / l),
      t("high", { height: millimetres(heightM) }),
      ...(material === undefined ? [] : [materialWord(material)]),
    ].join("; ");
  }

  /** Return the program's description of a surface; null before it was sent. */
  description(scene: Scene): string | null {
    return this.of(scene)?.says[language] ?? null;
  }

  private of(scene: Scene): Events["described"] | null {
    return this.described?.digest === scene.meta.digest ? this.described : null;
  }
}
