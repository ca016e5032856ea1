import assert from "node:assert/strict";
import { test } from "node:test";
import type { Outcome, Plan } from "kit/server/messages";
import { materialEdit } from "../../src/panels/materials/edit";
import { withoutNotes, progressOf, StageTable } from "../../src/panels/stages/table";

const step = (product: string, outcome: Outcome["outcome"], method = ""): Outcome =>
  ({ product, outcome, method, why: "", seconds: 0, notes: [] });
const plan = (digest: string, ...steps: Outcome[]): Plan => ({ digest, want: "touch", steps, slow: [], refusal: "" });
const states = (table: StageTable) => table.rows.map(({ product, state }) => `${product} ${state}`);

test("stages go from the plan over running to what became of them", () => {
  const table = new StageTable();
  table.setPlan(plan("a", step("views", "given"), step("disparity", "ran", "zncc"), step("touch", "ran", "proxy")));
  assert.deepEqual(states(table), ["views given", "disparity waiting", "touch waiting"]);
  table.start("a");
  table.update("disparity", "zncc", {}, 1000);
  assert.equal(table.rows[1].state, "running");
  assert.equal(progressOf(table.rows[1], 2000), null); // how long it takes is not known yet
  const notes = [{ text: "too dark", kind: "doubt" as const }];
  table.update("disparity", "zncc", { outcome: "ran", seconds: 4, why: "asked for; too dark", notes }, 5000);
  assert.deepEqual([table.rows[1].why, table.rows[1].notes], ["asked for", notes]);
  table.update("touch", "proxy", { outcome: "ran", seconds: 0.1 }, 5100);
  table.end("made");
  assert.deepEqual(states(table), ["views given", "disparity ran", "touch ran"]);
  table.setPlan(plan("b", step("disparity", "ran", "zncc"), step("touch", "ran", "penalty")));
  assert.deepEqual(table.rows.map(({ expected }) => expected), [4, 0]);
  table.start("b");
  table.update("disparity", "zncc", {}, 10_000);
  assert.equal(progressOf(table.rows[0], 11_000), 0.25);
  assert.equal(progressOf(table.rows[0], 60_000), 0.98); // done is when it says so
});

test("a plan for another text waits until what is made is made", () => {
  const table = new StageTable();
  table.start("a");
  table.setPlan(plan("a", step("disparity", "ran")));
  table.update("disparity", "", {}, 0);
  table.setPlan(plan("b", step("touch", "ran")));
  assert.deepEqual(states(table), ["disparity running"]);
  table.end("stopped");
  assert.deepEqual(states(table), ["touch waiting"]);
});

test("what was not finished was stopped or failed", () => {
  for (const [outcome, first] of [["stopped", "stopped"], ["failed", "failed"]] as const) {
    const table = new StageTable();
    table.start("a");
    table.setPlan(plan("a", step("disparity", "ran"), step("touch", "ran")));
    table.update("disparity", "", {}, 0);
    table.end(outcome);
    assert.deepEqual(states(table), [`disparity ${first}`, "touch stopped"]);
  }
});

test("why is told without the notes behind it", () => {
  assert.equal(withoutNotes("asked for; a; b", [{ text: "a", kind: "warning" }, { text: "b", kind: "doubt" }]), "asked for");
  assert.equal(withoutNotes("it fails", []), "it fails");
});

test("a segment becomes another material by the smallest change", () => {
  const why = "segment 2: number 1 of 3 from smooth to rough";
  const rule = { changes: { "materials.rules": [{ segment: 3, material: "ice" }] } };
  assert.deepEqual(materialEdit({ materials: { by: "roughness" } }, 2, "ice", why), rule);
  assert.deepEqual(materialEdit({}, 2, "ice", why), rule);
  assert.deepEqual(materialEdit({ materials: { "1": "sand" } }, 2, "ice", why), { changes: { "materials.3": "ice" } });
  assert.deepEqual(materialEdit({ materials: { by: { "1": "sand" } } }, 2, "ice", why), { changes: { "materials.by.3": "ice" } });
  const rules = [{ segment: 3, material: "sand" }, { colour: "red", material: "brick" }];
  assert.deepEqual(materialEdit({ materials: { rules, by: { "0": "sand" } } }, 2, "ice", "segment 2: rule 1, named -> sand"), {
    changes: { "materials.rules": [{ segment: 3, material: "ice" }, rules[1]] },
  });
});
