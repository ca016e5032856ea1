import assert from "node:assert/strict";
import { test } from "node:test";
import { corners, type Mapping, movePlacement, placement, reachOf, toPicture, wholePicture, zoomTo } from "kit/overlay/tools/placement";
import type { Vec } from "kit/server/protocol";
import { cases } from "./placement.json";

const near = (found: readonly number[], wanted: readonly number[], by: number) =>
  found.forEach((each, i) => assert.ok(Math.abs(each - wanted[i]) <= by, `${found} is not ${wanted}`));
const WORKSPACE: Vec = [0.1, 0.08, 0.1];
const plain: Mapping = { scale: null, region_m: null, rotation_deg: 0, offset_m: [0, 0, 0] };
const mappings: Mapping[] = [
  plain,
  { ...plain, scale: 2.5, rotation_deg: 30, offset_m: [0.01, -0.02, 0.005] },
  { ...plain, region_m: [0.01, 0.005, 0.02, 0.01] },
  { ...plain, region_m: [-0.01, 0.005, 0.02, 0.01], rotation_deg: 90, offset_m: [0.004, 0.002, 0] },
  { ...plain, region_m: [-0.01, 0.005, 0.02, 0.01], scale: 3, rotation_deg: -20 },
];

test("a hand is over the place of the picture that the core says", () => {
  assert.ok(cases.length > 4);
  for (const { mapping, workspace_m, hand_m, picture_m, scale } of cases) {
    const to = placement(mapping as Mapping, workspace_m as Vec);
    near([to.scale], [scale], 1e-9 * scale);
    near(toPicture(to, hand_m as Vec), picture_m, 1e-12);
  }
});

test("the frame is what the workspace covers", () => {
  for (const mapping of mappings) {
    const to = placement(mapping, WORKSPACE);
    const found = corners(reachOf(mapping, WORKSPACE));
    const sides = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    for (const [i, [u, v]] of sides.entries()) near(found[i], toPicture(to, [(u * WORKSPACE[0]) / 2, (v * WORKSPACE[1]) / 2, 0]).slice(0, 2), 1e-12);
  }
});

test("a frame that is dragged is where it was dragged to", () => {
  for (const mapping of mappings) {
    const before = reachOf(mapping, WORKSPACE);
    const there = reachOf(movePlacement(mapping, WORKSPACE, [0.012, -0.007], 1, before.turnDeg), WORKSPACE);
    near(there.centre, [0.012, -0.007], 1e-5 / placement(mapping, WORKSPACE).scale + 1e-5);
    near(there.size, before.size, 1e-4 * before.size[0]);
    const larger = reachOf(movePlacement(mapping, WORKSPACE, before.centre, 1.5, before.turnDeg), WORKSPACE);
    near(larger.size, before.size.map((side) => 1.5 * side), 1e-3 * before.size[0]);
    near(larger.centre, before.centre, 3e-5);
    const turned = movePlacement(mapping, WORKSPACE, before.centre, 1, before.turnDeg + 40);
    near([reachOf(turned, WORKSPACE).turnDeg], [before.turnDeg + 40], 0.01);
    near(reachOf(turned, WORKSPACE).centre, before.centre, 3e-5);
    assert.equal(turned.offset_m[2], mapping.offset_m[2]);
  }
});

test("a region fills the workspace, and the whole picture is what it was", () => {
  const close = zoomTo(mappings[1], 0.01, 0.005, 0.02, 0.01);
  const { size, centre } = reachOf({ ...close, rotation_deg: 0 }, WORKSPACE);
  near(centre, [0.01, 0.005], 1e-9);
  near([size[0]], [0.02], 1e-9);
  assert.ok(size[1] >= 0.01);
  assert.deepEqual(wholePicture(close), { ...mappings[1], scale: null, offset_m: [0, 0, 0.005] });
});

test("a frame cannot be dragged to where no mapping reaches", () => {
  const { scale, offset_m } = movePlacement(plain, WORKSPACE, [5, 0], 1e-9, 0);
  assert.ok(scale !== null && scale <= 1e3);
  assert.ok(Math.abs(offset_m[0]) <= 10);
});
