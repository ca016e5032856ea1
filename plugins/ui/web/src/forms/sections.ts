/** The parts of a pipeline file that have a form: stages with a choice of method, and blocks. */
import { type Option, options } from "./kinds";
import { alternatives, type FileSchema, type Schema } from "./schema";

export const STAGES = ["depth", "texture", "render", "device"] as const;
export const ORDER = ["depth", "texture", "heights", "simplify", "materials", "workspace", "mapping", "render", "device", "safety"] as const;
export type SectionName = (typeof ORDER)[number];

/** So many options are seen at once; the others are folded. */
export const PLAIN = 4;

export interface Method {
  name: string;
  about: string;
  options: Option[];
}

export interface Section {
  name: SectionName;
  /** Empty where nothing is to be chosen. */
  methods: Method[];
  /** Of a section without methods. */
  options: Option[];
}

export function sections(schema: FileSchema): Section[] {
  return ORDER.filter((name) => schema.properties[name]).map((name) => section(name, schema));
}

function section(name: SectionName, schema: FileSchema): Section {
  const forms = alternatives(schema.properties[name], schema.$defs);
  const blocks = forms.filter((each) => each.properties);
  if (!(STAGES as readonly string[]).includes(name)) {
    return { name, methods: [], options: blocks[0] ? options(blocks[0], schema.$defs) : [] };
  }
  return { name, options: [], methods: blocks.map((each) => method(each, schema)) };
}

function method(form: Schema, schema: FileSchema): Method {
  return {
    name: String(form.properties!.use.const),
    about: (form.description ?? "").trim(),
    options: options(form, schema.$defs),
  };
}
