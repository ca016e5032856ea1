/** The edit of the document that gives a segment another material. */
import { isLabels } from "../../forms/section";
import { at, type Edit, isMap } from "../../forms/values";
import { shownNumber } from "kit/words/part_words";
import type { Plain } from "kit/server/messages";

/** Return the edit: in a map from number to material, the segment's entry alone. If segments go by roughness, or a rule
 * decided this one, a rule for it comes first, and the others stay as they are. */
export function materialEdit(value: unknown, label: number, material: string, why: string): Edit {
  const block = at(value, ["materials"]);
  const number = shownNumber(label);
  if (isLabels(block)) return { changes: { [`materials.${number}`]: material } };
  const byRule = /^segment \d+: rule \d+,/.test(why);
  if (isMap(at(block, ["by"])) && !byRule) return { changes: { [`materials.by.${number}`]: material } };
  const before = at(block, ["rules"]);
  const rules = (Array.isArray(before) ? before : []).filter((each) => at(each, ["segment"]) !== number);
  return { changes: { "materials.rules": [{ segment: number, material }, ...rules] as Plain } };
}
