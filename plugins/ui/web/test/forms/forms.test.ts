import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { fieldOf } from "../../src/forms/complaints";
import { expandMaterials } from "../../src/forms/editor";
import { formatRange, type Kind, kindOf, type Option, step } from "../../src/forms/kinds";
import { alternatives, type FileSchema, type Schema } from "../../src/forms/schema";
import type { Plain } from "kit/server/messages";
import { sections } from "../../src/forms/sections";
import { asText, edit, fits, numberText, setInside, typedNumber, typedText, typedYaml } from "../../src/forms/values";
import type { Document } from "kit/server/messages";

const LENGTH = { type: "string", examples: ["6 mm"], pattern: "^[-+]?\\d+\\s*(m|cm|mm|um)$" };
const DEFS = { Hand: { type: "object", title: "Hand", properties: { mass_kg: { type: "number", minimum: 0, default: 1 } } } };
const kind = (schema: Schema): Kind => kindOf(schema, DEFS);
const none = "none";

test("a schema's alternatives become one control", () => {
  assert.deepEqual(kind({ type: "boolean" }), { kind: "switch" });
  assert.deepEqual(kind({ enum: [3, 5, 7], type: "integer" }), { kind: "choice", values: [3, 5, 7] });
  assert.deepEqual(kind({ anyOf: [{ enum: ["a", "b"] }, { type: "null" }] }), { kind: "choice", values: ["a", "b", null] });
  assert.deepEqual(kind({ anyOf: [{ type: "boolean" }, { const: "auto" }] }), { kind: "choice", values: [true, false, "auto"] });
  const length = kind({ anyOf: [{ type: "number", exclusiveMinimum: 0, maximum: 1 }, LENGTH, { type: "null" }] });
  assert.deepEqual(length, {
    kind: "number", integer: false, words: [], units: ["m", "cm", "mm", "um"], nullable: true,
    bounds: { least: 0, most: 1, above: true, below: false },
  });
  const auto = kind({ anyOf: [{ type: "integer", minimum: 1 }, { const: "auto" }] });
  assert.ok(auto.kind === "number" && auto.integer && auto.words[0] === "auto");
  assert.equal(kind({ anyOf: [{ format: "path", type: "string" }, { type: "null" }] }).kind, "text");
  const pair = kind({ prefixItems: [{ type: "number" }, { type: "integer" }], type: "array" });
  assert.ok(pair.kind === "tuple" && pair.parts.length === 2);
  const coupling = kind({ anyOf: [{ $ref: "#/$defs/Hand" }, { const: "auto" }, { type: "null" }] });
  assert.ok(coupling.kind === "either" && coupling.other.kind === "block");
  assert.deepEqual(coupling.words, ["auto", null]);
  const list = kind({ items: { $ref: "#/$defs/Hand" }, type: "array" });
  assert.ok(list.kind === "list" && list.item.kind === "block");
  const by = kind({ oneOf: [{ enum: ["roughness"] }, { type: "object", additionalProperties: { type: "string" } }] });
  assert.ok(by.kind === "either" && by.other.kind === "yaml");
  for (const odd of [{}, { type: "object" }, { anyOf: [{ type: "number" }, { type: "array", items: { type: "number" } }] }]) {
    assert.equal(kind(odd).kind, "yaml");
  }
});

test("what is typed is a number, a word, a quantity, or nothing, which is the default", () => {
  const size = kind({ anyOf: [{ type: "number" }, LENGTH, { const: "auto" }, { type: "null" }] });
  assert.ok(size.kind === "number");
  const typed = (text: string) => typedNumber(text, size, none);
  assert.deepEqual(typed(" 0.5 "), { value: 0.5 });
  assert.deepEqual(typed("0,5"), { value: 0.5 });
  assert.deepEqual(typed("1e-3"), { value: 0.001 });
  assert.deepEqual(typed("6 mm"), { value: "6 mm" });
  assert.deepEqual(typed("0,6 mm"), { value: "0.6 mm" });
  assert.deepEqual(typed("auto"), { value: "auto" });
  assert.deepEqual(typed("none"), { value: null });
  assert.deepEqual(typed(""), { gone: true });
  assert.deepEqual(typed("Infinity"), { value: "Infinity" });
  assert.deepEqual(typed("much"), { value: "much" }); // for the check to complain of, at this field
  assert.deepEqual(typedText("007", false, none), { value: "007" });
  assert.deepEqual(typedYaml("{0: ice}"), { written: "{0: ice}" });
});

test("a value that is shown and told again is the same", () => {
  const number = kind({ anyOf: [{ type: "number" }, LENGTH, { type: "null" }] });
  assert.ok(number.kind === "number");
  for (const value of [0.001, 1e-9, -3, 1e21, "6 mm", null]) {
    assert.deepEqual(typedNumber(numberText(value, none), number, none), { value });
  }
  for (const value of ["a b", "ü", "#!"]) assert.deepEqual(typedText(asText(value, none), true, none), { value });
  for (const value of [[1, [2]], { a: { b: null } }]) {
    const change = typedYaml(asText(value, none));
    assert.ok("written" in change);
    assert.deepEqual(JSON.parse(change.written), value);
  }
});

test("an edit names its key alone", () => {
  assert.deepEqual(edit("render.stiffness_n_per_m", { value: 500 }), { changes: { "render.stiffness_n_per_m": 500 } });
  assert.deepEqual(edit("render.law", { written: "{use: penalty}" }), { written: { "render.law": "{use: penalty}" } });
  assert.deepEqual(edit("depth.cost", { gone: true }), { removed: ["depth.cost"] });
});

test("one part of an entry of a list changes, and the rest of it stays", () => {
  const rule = { segment: 3, material: "ice" };
  assert.deepEqual(setInside(rule, ["material"], { value: "sand" }), { segment: 3, material: "sand" });
  assert.deepEqual(setInside(rule, ["segment"], { gone: true }), { material: "ice" });
  assert.deepEqual(setInside({}, ["hand", "mass_kg"], { value: 2 }), { hand: { mass_kg: 2 } });
  assert.deepEqual(setInside(rule, ["at"], { written: "[1, 2]" }), { ...rule, at: [1, 2] });
});

test("materials in short are spelt out before another key is set", () => {
  const document = { said: { materials: { "0": "ice" } } } as unknown as Document;
  assert.deepEqual(expandMaterials({ changes: { "materials.default": "sand" } }, document), {
    changes: { materials: { by: { "0": "ice" } }, "materials.default": "sand" },
  });
  const other = { changes: { "render.stiffness_n_per_m": 1 } };
  assert.equal(expandMaterials(other, document), other);
});

test("a complaint goes to its field, or to what is around it", () => {
  const there = new Set(["field:render", "field:render.stiffness_n_per_m", "field:materials.rules", "field:depth"]);
  const field = (...location: (string | number)[]) =>
    fieldOf({ location, text: "", line: null, column: null }, (id) => there.has(id));
  assert.equal(field("render", "stiffness_n_per_m"), "field:render.stiffness_n_per_m");
  assert.equal(field("materials", "rules", 2, "material"), "field:materials.rules");
  assert.equal(field("depth", "use"), "field:depth");
  assert.equal(field("render", "nonsense"), "field:render");
  assert.equal(field("scene"), null);
  assert.equal(field(), null);
});

test("bounds in words, and steps within them", () => {
  const said = (bounds: object, unit = "") =>
    formatRange({ above: false, below: false, ...bounds }, unit, "over", "under", "to");
  assert.equal(said({ least: 0.001, most: 10 }, "m"), "0.001 to 10 m");
  assert.equal(said({ least: 0, most: 1, above: true, below: true }), "over 0 to under 1");
  assert.equal(said({ least: 0, above: true }, "N/m"), "over 0 N/m");
  assert.equal(said({ least: 1 }), "≥ 1");
  assert.equal(said({ most: 5, below: true }), "under 5");
  assert.equal(said({}), "");
  assert.equal(step(true, { least: 0, most: 1, above: false, below: false }), 1);
  assert.equal(step(false, { least: 0, most: 1, above: false, below: false }), 0.01);
});

function leaves(options: Option[], path: string): { path: string; option: Option }[] {
  return options.flatMap((option) => {
    const here = `${path}.${option.name}`;
    const inside = [option.kind, ...(option.kind.kind === "list" ? [option.kind.item] : []), ...(option.kind.kind === "either" ? [option.kind.other] : [])];
    const blocks = inside.flatMap((each) => (each.kind === "block" ? leaves(each.options, here) : []));
    return [{ path: here, option }, ...blocks];
  });
}

/** The schema's bounds of an option, wherever they stand in it. */
function numbersOf(schema: Schema, file: FileSchema): Schema[] {
  return alternatives(schema, file.$defs).filter((each) => each.type === "number" || each.type === "integer");
}

test("a key that the page has no words for has a form, with its shorthand", () => {
  const shape = { enum: ["round", "sharp"], type: "string" };
  const grain = { anyOf: [{ type: "object", properties: { shape } }, { enum: ["round", "sharp"] }, { type: "null" }] };
  const proxy = { anyOf: [{ enum: ["proxy"] }, { type: "object", properties: { use: { const: "proxy" } } }] };
  const properties: Record<string, Schema> = { title: { type: "string" }, fine_grain: grain, render: proxy, parts: grain };
  const found = sections({ properties, $defs: {} });
  assert.deepEqual(found.map(({ name, title, word }) => [name, title, word]), [
    ["render", "Render", undefined],
    ["fine_grain", "Fine grain", "shape"],
  ]);
  assert.deepEqual(found[1].options.map(({ name }) => name), ["shape"]);
});

test("every option of every installed method has a control that can say its default and its bounds", (context) => {
  const path = process.env.TANGIBLE_SCHEMA;
  if (!path) return context.skip("Python writes the schema: tests/ui/test_form_schema.py");
  const file = JSON.parse(readFileSync(path, "utf8")) as FileSchema;
  const all = sections(file).flatMap(({ name, methods, options }) =>
    [...methods.map((each) => ({ path: `${name}.${each.name}`, options: each.options })), { path: name, options }],
  );
  const found = all.flatMap(({ path: at, options }) => leaves(options, at));
  assert.ok(found.length > 150, `${found.length} options`);
  assert.ok(all.filter(({ options }) => options.length).length > 25);
  const inYaml = new Set<string>();
  for (const { path: at, option } of found) {
    assert.ok(option.about, `${at} has no help`);
    assert.ok(option.title, `${at} has no name`);
    assert.ok(fits(option.byDefault, option.kind), `${at} cannot show its default ${JSON.stringify(option.byDefault)}`);
    if (option.kind.kind === "yaml") inYaml.add(at);
    if (option.kind.kind === "number") roundTrip(at, option.byDefault, option.kind);
  }
  assert.deepEqual([...inYaml].sort(), ["render.engraved.law", "render.with-materials.law"]); // any law
  for (const [name, schema] of Object.entries(file.properties)) bounds(name, schema, file, found);
  const of = (section: string) => all.find(({ path: at }) => at === section)?.options.map(({ name, kind }) => [name, kind.kind]);
  assert.deepEqual(of("heights"), [["by", "choice"], ["round_m", "number"], ["bulge_m", "number"], ["detail_m", "number"]]);
  for (const elsewhere of ["parts", "title", "language"]) assert.equal(of(elsewhere), undefined); // in a panel of their own
});

function roundTrip(at: string, byDefault: Plain | undefined, kind: Kind & { kind: "number" }): void {
  if (byDefault === undefined) return;
  assert.deepEqual(typedNumber(numberText(byDefault, none), kind, none), { value: byDefault }, at);
}

function bounds(section: string, schema: Schema, file: FileSchema, found: { path: string; option: Option }[]): void {
  for (const form of alternatives(schema, file.$defs)) {
    const use = form.properties?.use?.const;
    for (const [name, option] of Object.entries(form.properties ?? {})) {
      const made = found.find(({ path }) => path === [section, use, name].filter(Boolean).join("."))?.option.kind;
      if (made?.kind !== "number") continue;
      const [number] = numbersOf(option, file);
      assert.equal(made.bounds.least, number.minimum ?? number.exclusiveMinimum, `${section} ${name}`);
      assert.equal(made.bounds.most, number.maximum ?? number.exclusiveMaximum, `${section} ${name}`);
    }
  }
}
