/** Which control an option gets, by its schema. What no other control can say is written in YAML. */
import { alternatives, type Definitions, type Plain, type Schema } from "./schema";

export interface Bounds {
  least?: number;
  most?: number;
  /** Whether the bound itself is no value any more. */
  above: boolean;
  below: boolean;
}

export type Kind =
  | { kind: "switch" }
  | { kind: "choice"; values: Plain[] }
  /** words: what may stand in place of a number; units: whether it may be written with a unit. */
  | { kind: "number"; integer: boolean; bounds: Bounds; words: string[]; units: string[]; nullable: boolean }
  | { kind: "text"; nullable: boolean; suggest: Plain[] }
  | { kind: "tuple"; parts: Kind[]; nullable: boolean }
  | { kind: "block"; options: Option[] }
  | { kind: "list"; item: Kind }
  /** One of a few words, or something of another kind. */
  | { kind: "either"; words: Plain[]; other: Kind }
  | { kind: "yaml" };

export interface Option {
  name: string;
  title: string;
  unit: string;
  about: string;
  /** Undefined for one that must be given. */
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

/** Bounds and unit in words and signs: "0.001 to 10 m", "over 0 N/m"; empty where there are none. */
export function bounded({ least, most, above, below }: Bounds, unit: string, over: string, under: string, to: string): string {
  const behind = unit && ` ${unit}`;
  if (least !== undefined && most !== undefined) {
    const from = above ? `${over} ${number(least)}` : number(least);
    return `${from} ${to} ${below ? `${under} ` : ""}${number(most)}${behind}`;
  }
  if (least !== undefined) return `${above ? over : "≥"} ${number(least)}${behind}`;
  if (most !== undefined) return `${below ? under : "≤"} ${number(most)}${behind}`;
  return "";
}

/** How far an arrow key goes: a round step, a twentieth of the range or less. */
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

/** A quantity's pattern ends with its units: ...(m|cm|mm|um)$ */
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

function number(value: number): string {
  return String(value);
}

export function sentence(name: string): string {
  const words = name.replaceAll("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}
