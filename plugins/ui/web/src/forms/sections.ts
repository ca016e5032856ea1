/** Sections of a pipeline file with a form: stages with a choice of method, and blocks. */
import { type Option, options, sentence } from "./kinds";
import { alternatives, type FileSchema, type Schema } from "./schema";

/** The order of the forms; a key that is not in it stands behind the others. */
const ORDER = ["depth", "texture", "heights", "simplify", "relief", "materials", "workspace", "mapping", "render", "device", "safety"];
/** Keys that have a panel of their own, without a form. */
const ELSEWHERE = ["scene", "parts", "export"];

/** Number of options that are not folded. */
export const PLAIN = 4;

export interface Method {
  name: string;
  about: string;
  options: Option[];
}

export interface Section {
  name: string;
  /** The name in words, for a section that the page has no words for. */
  title: string;
  /** Methods to choose from; empty for a block. */
  methods: Method[];
  /** Options of a section without methods. */
  options: Option[];
  /** The option that a word alone stands for. */
  word?: string;
}

/** A section for each key of the schema that is a block of options. */
export function sections(schema: FileSchema): Section[] {
  const place = (name: string): number => (ORDER.includes(name) ? ORDER.indexOf(name) : ORDER.length);
  return Object.keys(schema.properties)
    .filter((name) => !ELSEWHERE.includes(name))
    .map((name) => section(name, schema))
    .filter((each) => each !== null)
    .sort((one, other) => place(one.name) - place(other.name));
}

function section(name: string, schema: FileSchema): Section | null {
  const forms = alternatives(schema.properties[name], schema.$defs);
  const blocks = forms.filter((each) => each.properties);
  if (!blocks.length) return null;
  const title = sentence(name);
  if (blocks[0].properties!.use) {
    return { name, title, options: [], methods: blocks.map((each) => method(each, schema)) };
  }
  return { name, title, methods: [], options: options(blocks[0], schema.$defs), word: wordOf(forms, blocks[0]) };
}

/** The option that takes the same words as stand for the whole block. */
function wordOf(forms: Schema[], block: Schema): string | undefined {
  const words = forms.find((each) => each.enum)?.enum;
  if (!words) return undefined;
  const same = (option: Schema): boolean => JSON.stringify(option.enum) === JSON.stringify(words);
  return Object.entries(block.properties!).find(([, option]) => same(option))?.[0];
}

function method(form: Schema, schema: FileSchema): Method {
  return {
    name: String(form.properties!.use.const),
    about: (form.description ?? "").trim(),
    options: options(form, schema.$defs),
  };
}
