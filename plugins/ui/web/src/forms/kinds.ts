/** Kinds of controls by schema. Values without a control are written in YAML. */
import { alternatives, type Definitions, type Schema } from "./schema";
import type { Plain } from "kit/server/messages";
import { notation } from "kit/words/words";

export interface Bounds {
  least?: number;
  most?: number;
  /** True if the bound itself is excluded. */
  above: boolean;
  below: boolean;
}

export type Kind =
  | { kind: "switch" }
  | { kind: "choice"; values: Plain[] }
  /** A number. words: allowed instead of a number; units: those it may be written with. */
  | { kind: "number"; integer: boolean; bounds: Bounds; words: string[]; units: string[]; nullable: boolean }
  | { kind: "text"; nullable: boolean; suggest: Plain[] }
  | { kind: "tuple"; parts: Kind[]; nullable: boolean }
  | { kind: "block"; options: Option[] }
  | { kind: "list"; item: Kind }
  /** A choice of words, or a value of another kind. */
  | { kind: "either"; words: Plain[]; other: Kind }
  | { kind: "yaml" };

export interface Option {
  name: string;
  title: string;
  unit: string;
  about: string;
  /** Default; undefined for a required option. */
  byDefault: Plain | undefined;
  kind: Kind;
}

export function options(schema: Schema, defs: Definitions): Option[] {
  return Object.entries(schema.properties ?? {})
    .filter(([name]) => name !== "use")
    .map(([name, option]) => ({
      name,
      title: option.title ?? sentence(name),
      unit: option.unit ?? "",
      about: (option.description ?? "").replace(/\s+/g, " ").trim(),
      byDefault: option.default,
      kind: kindOf(option, defs),
    }));
}

export function kindOf(schema: Schema, defs: Definitions): Kind {
  const all = alternatives(schema, defs);
  const nullable = all.some((each) => each.type === "null");
  const forms = all.filter((each) => each.type !== "null");
  const words = forms.flatMap(constants);
  const rest = forms.filter((each) => !constants(each).length);
  const nulls: Plain[] = nullable ? [null] : [];
  if (!rest.length) return words.length ? choice([...words, ...nulls]) : { kind: "yaml" };
  if (rest.every((each) => each.type === "boolean")) {
    return words.length || nullable ? choice([true, false, ...words, ...nulls]) : { kind: "switch" };
  }
  const numbers = rest.filter(isNumber);
  const quantities = rest.filter((each) => each.type === "string" && each.examples && each.pattern);
  if (numbers.length === 1 && numbers.length + quantities.length === rest.length) {
    return {
      kind: "number",
      integer: numbers[0].type === "integer",
      bounds: bounds(numbers[0]),
      words: words.map(String),
      units: quantities.flatMap(unitsOf),
      nullable,
    };
  }
  const alone = rest.length === 1 ? structure(rest[0], defs) : null;
  if (!alone) return words.length || nullable ? { kind: "either", words: [...words, ...nulls], other: { kind: "yaml" } } : { kind: "yaml" };
  if (alone.kind === "text") return { ...alone, nullable, suggest: words };
  if (alone.kind === "tuple" && !words.length) return { ...alone, nullable };
  return words.length || nullable ? { kind: "either", words: [...words, ...nulls], other: alone } : alone;
}

const number = (value: number): string => notation(String(value));

/** Return bounds and unit in words: "0.001 to 10 m", "over 0 N/m"; empty without bounds. */
export function formatRange({ least, most, above, below }: Bounds, unit: string, over: string, under: string, to: string): string {
  const behind = unit && ` ${unit}`;
  if (least !== undefined && most !== undefined) {
    const from = above ? `${over} ${number(least)}` : number(least);
    return `${from} ${to} ${below ? `${under} ` : ""}${number(most)}${behind}`;
  }
  if (least !== undefined) return `${above ? over : "≥"} ${number(least)}${behind}`;
  if (most !== undefined) return `${below ? under : "≤"} ${number(most)}${behind}`;
  return "";
}

/** Return the step of an arrow key: a power of ten, a twentieth of the range or less. */
export function step(integer: boolean, { least, most }: Bounds): number {
  if (integer) return 1;
  if (least === undefined || most === undefined) return 1;
  return 10 ** Math.floor(Math.log10((most - least) / 20 || 1));
}

function structure(form: Schema, defs: Definitions): Kind | null {
  if (form.type === "string") return { kind: "text", nullable: false, suggest: [] };
  if (form.prefixItems) return { kind: "tuple", parts: form.prefixItems.map((each) => kindOf(each, defs)), nullable: false };
  if (form.type === "array" && form.items) {
    const item = kindOf(form.items, defs);
    return item.kind === "block" ? { kind: "list", item } : null;
  }
  return form.properties ? { kind: "block", options: options(form, defs) } : null;
}

function choice(values: Plain[]): Kind {
  return { kind: "choice", values };
}

function constants(form: Schema): Plain[] {
  return form.enum ?? (form.const === undefined ? [] : [form.const]);
}

function isNumber({ type }: Schema): boolean {
  return type === "number" || type === "integer";
}

/** Return the units of a quantity, the end of its pattern: ...(m|cm|mm|um)$ */
function unitsOf({ pattern }: Schema): string[] {
  return /\(([^()]+)\)\$$/.exec(pattern!)?.[1].split("|") ?? [];
}

function bounds(form: Schema): Bounds {
  return {
    least: form.exclusiveMinimum ?? form.minimum,
    most: form.exclusiveMaximum ?? form.maximum,
    above: form.exclusiveMinimum !== undefined,
    below: form.exclusiveMaximum !== undefined,
  };
}

export function sentence(name: string): string {
  const words = name.replaceAll("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}
