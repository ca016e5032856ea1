import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { borders } from "../../src/panels/parts/board/borders";
import { Viewport } from "../../src/panels/parts/board/viewport";
import { Mask } from "../../src/panels/parts/pixels/mask";
import { picture } from "./pictures";

describe("sight", () => {
  const seen = (): Viewport => {
    const sight = new Viewport(400, 300);
    sight.resize(800, 900);
    return sight;
  };

  test("the whole picture is seen at first, in the middle, and still when the board is resized", () => {
    const sight = seen();
    assert.deepEqual([sight.zoom, sight.toBoard([0, 0]), sight.toBoard([400, 300])], [2, [0, 150], [800, 750]]);
    sight.resize(400, 300);
    assert.deepEqual([sight.zoom, sight.toBoard([0, 0])], [1, [0, 0]]);
    sight.zoomBy(4);
    sight.resize(500, 300);
    assert.equal(sight.zoom, 4);
  });

  test("what is under the pointer stays there, and places lead back", () => {
    const sight = seen();
    const at = sight.toPicture([200, 400]);
    sight.zoomBy(3, [200, 400]);
    assert.deepEqual(sight.toPicture([200, 400]).map((each) => Math.round(1e6 * each)), at.map((each) => Math.round(1e6 * each)));
    assert.deepEqual(sight.toBoard(sight.toPicture([5, 7])).map((each) => Math.round(1e6 * each) / 1e6), [5, 7]);
  });

  test("a crosshair is brought into sight, and one that is seen moves nothing", () => {
    const sight = seen();
    assert.ok(!sight.reveal([0.5, 0.5]) && !sight.reveal([399.5, 299.5]));
    sight.zoomBy(8, [400, 450]);
    assert.ok(sight.reveal([399.5, 10.5]));
    const [x, y] = sight.toBoard([399.5, 10.5]);
    assert.ok(x > 0 && x < 800 && y > 0 && y < 900, `${x} ${y}`);
  });
});

test("borders are a dark line beside a light one, the selected part's in the colour of the theme, proposals are dashed", () => {
  (globalThis as { ImageData?: unknown }).ImageData = class {
    data: Uint8ClampedArray;
    constructor(
      readonly width: number,
      readonly height: number,
    ) {
      this.data = new Uint8ClampedArray(4 * width * height);
    }
  };
  const labels = picture(...Array<string>(10).fill("aaaaabbbbbccccc"));
  const sight = new Viewport(15, 10);
  sight.resize(15, 10);
  const look = { labels, selected: 2, proposed: null as Mask | null, accent: 7, against: 8, thin: 9, ratio: 0.67 };
  const row = (box = { left: 0, top: 4, right: 15, bottom: 5 }): number[] => [...new Uint32Array(borders(look, sight, box).data.buffer)];
  const [dark, light] = [0xd0000000, 0xe6ffffff];
  const whole = row();
  assert.deepEqual(whole.slice(3, 7), [0, dark, light, 0]);
  assert.equal(whole[9], 8);
  assert.ok(whole.slice(10, 12).every((each) => each === 7));
  assert.deepEqual(row({ left: 4, top: 4, right: 11, bottom: 5 }), whole.slice(4, 11), "a part of it is the same");
  look.proposed = new Mask(15, 10);
  look.proposed.put([[4, 1, 4]], true);
  assert.notDeepEqual(row(), whole);
});
