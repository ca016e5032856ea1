import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";

test("three is there", () => {
  assert.equal(new Vector3(3, 4, 0).length(), 5);
});
