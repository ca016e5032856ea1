/** Cures as sentences: what a change of the document does, for people who have never seen its keys. */
import type { Verdict } from "kit/server/messages";
import { decimal } from "kit/words/words";
import { t } from "./words";

type Value = Verdict["changes"][number]["value"];
type Word = Parameters<typeof t>[0];

/** Return the verdicts, each once: two segments of a material have the same one. */
export function distinct<T extends Pick<Verdict, "check" | "of" | "stands">>(verdicts: T[]): T[] {
  return [...new Map(verdicts.map((each) => [JSON.stringify([each.check, each.of, each.stands]), each])).values()];
}

/** The sentence of each key, and its value in words. */
const SENTENCES: Record<string, [Word, (value: Value) => string]> = {
  "workspace.width_m": ["wider", length],
  "workspace.relief_m": ["relief", length],
  "relief.relief_m": ["relief", length],
  "workspace.smooth_m": ["smooth", length],
  "relief.slope": ["slope", (value) => decimal((180 / Math.PI) * Math.atan(Number(value)), 0)],
  "simplify.gap_m": ["gap", length],
  "simplify.part_m": ["part", length],
  "simplify.textures": ["textures", String],
  "materials.fit": ["fit", String],
  "safety.coupling": ["coupling", String],
  "safety.stiffness_margin": ["margin", (value) => decimal(100 * Number(value), 0)],
  "render.stiffness_n_per_m": ["stiffness", (value) => decimal(Number(value), 0)],
  "render.damping_n_s_per_m": ["damping", (value) => decimal(Number(value), 1)],
};
/** The sentences of options of exporters, whatever the exporter. */
const OPTIONS: Record<string, [Word, (value: Value) => string]> = {
  width_m: ["wider", length],
  longer_side_m: ["longer", length],
  page: ["page", (value) => String(value).replace(/^a(?=\d)/, "A")],
};

/** Return what setting a key to a value does, as a sentence. */
export function sentenceOf(key: string, value: Value): string {
  const [kind, , option] = key.split(".");
  const found = kind === "export" ? OPTIONS[option ?? ""] : SENTENCES[key];
  return found ? t(found[0], { value: found[1](value) }) : t("set", { key, value: typeof value === "string" ? value : JSON.stringify(value) });
}

/** Return what a cure says besides its changes, which are buttons. */
export function restOf({ cure, changes }: Pick<Verdict, "cure" | "changes">): string {
  if (!changes.length) return cure;
  return cure.replace(/`[\w.-]+: [^`]*`/g, "").replace(/^[\s,;:]+|[\s,;:]+$/g, "").replace(/(, )+/g, ", ");
}

/** Return a length in the unit that a person would take for it. */
function length(value: Value): string {
  const mm = 1000 * Number(value);
  return mm >= 100 ? t("cm", { value: decimal(mm / 10, mm % 10 >= 0.5 ? 1 : 0) }) : t("mm", { value: decimal(mm, Number.isInteger(Math.round(1e6 * mm) / 1e6) ? 0 : 1) });
}
