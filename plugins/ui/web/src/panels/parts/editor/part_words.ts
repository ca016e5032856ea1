/** Parts in words: their names, heights, sizes and places. */
import { t } from "./words";
import { ninthOfPicture } from "kit/words/place_words";
import { decimal } from "kit/words/words";
import type { Part } from "../drawing/drawing";
import type { Labels } from "../pixels/labels";
import type { Place } from "../pixels/pieces";

export const nameOf = (part: Part | undefined, number: number): string => part?.name || t("nameless", { number });

export const heightOf = ({ height_m, automatic }: Part): string =>
  automatic ? t("automatic") : t("mm", { height: decimal(1000 * height_m, 2) });

export const shareOf = (share: number): string => t("percent", { share: decimal(100 * share, share < 0.01 ? 2 : share < 0.1 ? 1 : 0) });

export const placeOf = ({ at: [x, y] }: Place, { columns, rows }: Labels): string => ninthOfPicture(x / columns, y / rows);

export const sliversInWords = (count: number): string => (count === 1 ? t("givenOne") : t("given", { count }));
