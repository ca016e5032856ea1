/** The part of JSON Schema that pipeline files use. */
import type { Plain } from "kit/server/messages";

export interface Schema {
  type?: string;
  const?: Plain;
  enum?: Plain[];
  anyOf?: Schema[];
  oneOf?: Schema[];
  $ref?: string;
  items?: Schema;
  prefixItems?: Schema[];
  properties?: Record<string, Schema>;
  required?: string[];
  additionalProperties?: boolean | Schema;
  pattern?: string;
  format?: string;
  examples?: Plain[];
  minimum?: number;
  exclusiveMinimum?: number;
  maximum?: number;
  exclusiveMaximum?: number;
  default?: Plain;
  title?: string;
  description?: string;
  /** Unit of a number written without one. */
  unit?: string;
}

export type Definitions = Record<string, Schema>;

export interface FileSchema extends Schema {
  properties: Record<string, Schema>;
  $defs: Definitions;
}

/** Return the alternatives of a schema, references resolved. */
export function alternatives(schema: Schema, defs: Definitions): Schema[] {
  if (schema.$ref) return alternatives(defs[schema.$ref.split("/").at(-1)!] ?? {}, defs);
  return (schema.anyOf ?? schema.oneOf)?.flatMap((each) => alternatives(each, defs)) ?? [schema];
}
