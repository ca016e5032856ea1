import assert from "node:assert/strict";
import { test } from "node:test";
import { Steps } from "../../src/panels/export/progress";
import { distinct, restOf, sentenceOf } from "../../src/panels/verdicts/cures";

test("cures are sentences without keys", () => {
  const said = [
    sentenceOf("workspace.width_m", 0.21), sentenceOf("export.swell.width_m", 0.215), sentenceOf("export.swell.page", "a3"),
    sentenceOf("export.stl.longer_side_m", 0.095), sentenceOf("simplify.gap_m", 0.0032), sentenceOf("simplify.textures", 5), sentenceOf("relief.slope", 1),
  ];
  assert.deepEqual(said, [
    "Make it 21 cm wide", "Make it 21.5 cm wide", "Print it on A3 paper", "Make its longer side 95 mm long",
    "Give places narrower than 3.2 mm to their neighbours", "Use at most 5 textures", "Make no slope steeper than 45°",
  ]);
  assert.equal(sentenceOf("acme.grip", 2), "Set acme.grip to 2", "of a plugin");
});

test("a verdict that two segments share stands once", () => {
  const metal = { check: "texture", of: "metal", stands: "550 um < 600 um" };
  const wood = { ...metal, of: "wood" };
  assert.deepEqual(distinct([metal, wood, { ...metal }]), [metal, wood]);
});

test("what a cure says besides its buttons stays", () => {
  const cure = "`simplify.gap_m: 0.0032`, `workspace.width_m: 0.21`, or have fewer and larger parts";
  const changes = [{ key: "simplify.gap_m", value: 0.0032, towards: "at least" as const }];
  assert.equal(restOf({ cure, changes }), "or have fewer and larger parts");
  assert.equal(restOf({ cure: "make one of them 1 mm higher (`height_m` under `parts:`)", changes: [] }), "make one of them 1 mm higher (`height_m` under `parts:`)");
});

test("the progress of an export moves with every product, file by file", () => {
  const steps = new Steps(["swell", "stl"]);
  const values = [steps.value];
  const texts: string[] = [];
  for (const [product, finished] of [["simplified", false], ["simplified", true], ["export: swell", false], ["export: swell", true], ["relief", false], ["relief", true], ["export: stl", true]] as const) {
    texts.push(steps.take(product, finished));
    values.push(steps.value);
  }
  assert.ok(values.every((each, i) => i === 0 || each >= values[i - 1]!));
  assert.deepEqual([values[4], values.at(-1), steps.total], [1, 2, 2]);
  assert.ok(new Set(values).size >= 5, "it moves within a file as well");
  assert.equal(texts[0], "File 1 of 2, Swell paper (SVG, PDF): Legible parts …");
  assert.equal(texts[4], "File 2 of 2, 3D print (STL): Relief …");
});
