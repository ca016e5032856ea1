/** Which keys of the document make a segment another material. */
import { isLabels } from "../../forms/section";
import { at, type Edit, isMap } from "../../forms/values";
import type { Plain } from "../../forms/schema";

/**
 * In a map from label to material, that segment's entry alone. Where segments go by roughness, or a rule decided this
 * one, a rule for it comes first, and what decides the others stays as it is.
 */
export function chosen(said: unknown, label: number, material: string, why: string): Edit {
  const block = at(said, ["materials"]);
  if (isLabels(block)) return { changes: { [`materials.${label}`]: material } };
  const byRule = /^segment \d+: rule \d+,/.test(why);
  if (isMap(at(block, ["by"])) && !byRule) return { changes: { [`materials.by.${label}`]: material } };
  const before = at(block, ["rules"]);
  const rules = (Array.isArray(before) ? before : []).filter((each) => at(each, ["segment"]) !== label);
  return { changes: { "materials.rules": [{ segment: label, material }, ...rules] as Plain } };
}
