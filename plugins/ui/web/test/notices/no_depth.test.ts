import assert from "node:assert/strict";
import { test } from "node:test";
import { madeOf } from "../../src/notices/no_depth";

test("a photograph without depth alone is made of something else", () => {
  assert.equal(madeOf({ scene_kind: "photograph", relief_from: "edges" }), "edges");
  assert.equal(madeOf({ scene_kind: "photograph", relief_from: "photograph" }), "photograph");
  for (const relief_from of ["depth", "parts"] as const) assert.equal(madeOf({ scene_kind: "photograph", relief_from }), null, relief_from);
  assert.equal(madeOf({ scene_kind: "depth", relief_from: "edges" }), null, "the edges of a pair are those of its depth");
  assert.equal(madeOf({ scene_kind: "heights", relief_from: "heights" }), null);
  assert.equal(madeOf({ scene_kind: null, relief_from: null }), null);
});
