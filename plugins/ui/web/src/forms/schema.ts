/** JSON Schema, as far as pipeline files use it. */

export type Plain = string | number | boolean | null | Plain[] | { [key: string]: Plain };

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
  /** Of a number: what it is in where nothing stands behind it. */
  unit?: string;
}

export type Definitions = Record<string, Schema>;

export interface FileSchema extends Schema {
  properties: Record<string, Schema>;
  $defs: Definitions;
}

/** All that a schema may be, references followed, alternatives side by side. */
export function alternatives(schema: Schema, defs: Definitions): Schema[] {
  if (schema.$ref) return alternatives(defs[schema.$ref.split("/").at(-1)!] ?? {}, defs);
  return (schema.anyOf ?? schema.oneOf)?.flatMap((each) => alternatives(each, defs)) ?? [schema];
}
