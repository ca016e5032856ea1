/** Values of a pipeline file as people read and type them. */
import type { Kind } from "./kinds";
import type { Plain } from "kit/server/messages";
import { notation } from "kit/words/words";

/** Change of a key by its field: a value, a value written in YAML, or removal, so that the default applies. */
export type FieldChange = { value: Plain } | { written: string } | { gone: true };

/** An edit of the document, as the server takes it. */
export interface Edit {
  changes?: Record<string, Plain>;
  written?: Record<string, string>;
  removed?: string[];
}

export function edit(key: string, change: FieldChange): Edit {
  if ("value" in change) return { changes: { [key]: change.value } };
  return "written" in change ? { written: { [key]: change.written } } : { removed: [key] };
}

/** Return a value as text of a field; structured values as JSON, which is YAML. */
export function asText(value: Plain | undefined, none: string): string {
  if (value === undefined) return "";
  if (value === null) return none;
  return typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** Return a number, a word, or a number with its unit in the language's notation; `typedNumber` takes it back. */
export function numberText(value: Plain | undefined, none: string): string {
  return asText(value, none).split(" ").map(notation).join(" ");
}

/** Return the change by a text typed into a number field: a number, an allowed word, or a text such as "6 mm", which the
 * document's check judges. Empty removes the key. */
export function typedNumber(text: string, kind: Kind & { kind: "number" }, none: string): FieldChange {
  const plain = text.trim();
  if (!plain) return { gone: true };
  if (kind.nullable && plain === none) return { value: null };
  if (kind.words.includes(plain)) return { value: plain };
  const point = /^[-+]?\d+,\d+(?!\d*,)/.test(plain) ? plain.replace(",", ".") : plain;
  const number = Number(point);
  return { value: Number.isFinite(number) ? number : point };
}

export function typedText(text: string, nullable: boolean, none: string): FieldChange {
  if (!text) return { gone: true };
  return { value: nullable && text === none ? null : text };
}

export function typedYaml(text: string): FieldChange {
  return text.trim() ? { written: text } : { gone: true };
}

export function same(one: Plain | undefined, other: Plain | undefined): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}

/** Return whether a control of this kind can show this value; if not, it is shown in YAML. */
export function fits(value: Plain | undefined, kind: Kind): boolean {
  if (value === undefined) return true;
  switch (kind.kind) {
    case "switch":
      return typeof value === "boolean";
    case "choice":
      return kind.values.some((each) => same(each, value));
    case "number":
      return value === null ? kind.nullable : typeof value === "number" || typeof value === "string";
    case "text":
      return value === null ? kind.nullable : typeof value === "string";
    case "tuple":
      if (value === null) return kind.nullable;
      return Array.isArray(value) && value.length === kind.parts.length && value.every((each, valueAt) => fits(each, kind.parts[valueAt]));
    case "block":
      return isMap(value) && Object.keys(value).every((name) => kind.options.some((each) => each.name === name)) &&
        kind.options.every((each) => fits(value[each.name], each.kind));
    case "list":
      return Array.isArray(value) && value.every((each) => fits(each, kind.item));
    case "either":
      return kind.words.some((each) => same(each, value)) || fits(value, kind.other);
    case "yaml":
      return true;
  }
}

export function isMap(value: Plain | undefined): value is { [key: string]: Plain } {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** Return a value with a change applied inside. */
export function setInside(value: Plain, inside: readonly string[], change: FieldChange): Plain {
  if (!inside.length) return "value" in change ? change.value : "written" in change ? fromText(change.written) : {};
  const [name, ...deeper] = inside;
  const { [name]: before, ...rest } = isMap(value) ? value : {};
  if ("gone" in change && !deeper.length) return rest;
  return { ...rest, [name]: setInside(before ?? {}, deeper, change) };
}

/** Return written YAML as JSON if it is JSON, else as text, within a value that is set as a whole. */
function fromText(written: string): Plain {
  try {
    return JSON.parse(written) as Plain;
  } catch {
    return written;
  }
}

/** Return the value at a path of keys. */
export function at(value: unknown, path: readonly (string | number)[]): Plain | undefined {
  let here = value;
  for (const part of path) {
    if (typeof here !== "object" || here === null) return undefined;
    here = (here as Record<string, unknown>)[part];
  }
  return here as Plain | undefined;
}
