import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { FLAGS } from "kit/server/protocol";
import { Stroke } from "kit/speech/stroke";
import { Telling } from "kit/speech/telling";
import { STAY_MS } from "kit/speech/tour";
import { Explorer, explore, type Picture, sceneOf } from "./exploration";

const [ROWS, COLUMNS] = [60, 80];

/** 80 x 60 mm: a wall at 0, a door from 20 to 50 mm at 2 mm, a knob of 4 x 4 mm in it at 3 mm. */
function house(names: string[] | null = ["wall", "door", "knob"]): Picture {
  const labels = Array.from({ length: ROWS * COLUMNS }, (_, k) => {
    const [column, row] = [k % COLUMNS, Math.floor(k / COLUMNS)];
    if (column >= 40 && column < 44 && row >= 28 && row < 32) return 2;
    return column >= 20 && column < 50 ? 1 : 0;
  });
  const heights_m = labels.map((label) => [0, 0.002, 0.003][label]!);
  return { rows: ROWS, columns: COLUMNS, extent_m: [0.08, 0.06], heights_m, labels, names, materials: ["stone", "wood", "metal"] };
}

function explorer(picture = house()): Explorer {
  const hand = new Explorer(sceneOf(picture));
  hand.put(-0.03, 0.02);
  hand.down = true;
  hand.rest(3000);
  return hand;
}

describe("a stroke", () => {
  test("tells each edge with how far it goes up or down and the part behind it, and the rim", () => {
    const hand = explorer();
    assert.deepEqual(hand.said.splice(0), ["Touching wall, stone."]);
    hand.hold("ArrowRight");
    hand.listen();
    assert.deepEqual(hand.said.join(" ").split(/(?<=\.) /), [
      "Up 2.0 mm: door, wood.", "Down 2.0 mm: wall, stone.", "Right rim of the picture.",
    ]);
  });

  test("names a part without a name by its number from 1", () => {
    const hand = explorer(house(null));
    hand.hold("ArrowRight");
    hand.listen();
    assert.match(hand.said.join(" "), /Up 2\.0 mm: wood, part 2\. Down 2\.0 mm: stone, part 1\./);
  });

  test("tells nothing of a hand that trembles on an edge, and one crossing of one that goes over", () => {
    const stroke = new Stroke(sceneOf(house()));
    stroke.begin([-0.0203, 0]);
    for (let i = 0; i < 50; i++) assert.deepEqual(stroke.to([-0.02 + (i % 2 ? 0.0002 : -0.0002), 0]), []);
    assert.deepEqual(stroke.to([-0.018, 0]).map(({ kind }) => kind), ["edge"]);
    assert.deepEqual(stroke.to([-0.0185, 0]), []);
  });

  test("meets every part between two places, and none where the hand was lifted over", () => {
    const stroke = new Stroke(sceneOf(house()));
    stroke.begin([-0.03, 0]);
    const met = stroke.to([0.03, 0]);
    const rises = met.map((each) => (each.kind === "edge" ? Math.round(1e4 * each.riseM) / 10 : each.kind));
    assert.deepEqual(rises, [2, 1, -1, -2]);
    stroke.begin([-0.03, 0]);
    assert.deepEqual(stroke.to([0.03, 0]).length, 4);
  });

  test("of many edges the last are told, after the number of the others", () => {
    const labels = Array.from({ length: 20 * COLUMNS }, (_, k) => Math.floor((k % COLUMNS) / 5) % 2);
    const picture = { ...house(), rows: 20, extent_m: [0.08, 0.02] as [number, number], labels, heights_m: labels.map((each) => 0.002 * each), names: ["low", "high"], materials: ["wood", "wood"] };
    const said = explore({ ...picture }, 2);
    assert.ok(said.some((each) => /^Over (\d+ other edges|another edge); /.test(each)), said.join("\n"));
    assert.ok(said.every((each) => (each.match(/mm: /g) ?? []).length <= 2));
  });

  test("counts edges alone among what is left out", () => {
    const edges = (count: number): string => {
      const telling = new Telling({ now: () => 0 });
      telling.add({ kind: "contact", contact: "touching", what: "wall" });
      for (let i = 0; i < count; i++) telling.add({ kind: "edge", what: `part ${i}`, riseM: 0.001 });
      return telling.take();
    };
    assert.match(edges(1), /^Touching wall\. Up 1\.0 mm: part 0\./);
    assert.match(edges(2), /^Up 1\.0 mm: part 0\./);
    assert.match(edges(3), /^Over another edge; Up 1\.0 mm: part 1\./);
    assert.match(edges(4), /^Over 2 other edges; Up 1\.0 mm: part 2\./);
  });

  test("what was met more than two seconds ago is not told", () => {
    let nowMs = 0;
    const telling = new Telling({ now: () => nowMs });
    telling.add({ kind: "edge", what: "cup", riseM: 0.001 });
    nowMs = 1500;
    telling.add({ kind: "edge", what: "plate", riseM: 0.001 });
    nowMs = 3000;
    assert.equal(telling.take(), "Up 1.0 mm: plate.");
  });
});

describe("contact", () => {
  test("that lasts for a moment is not announced: neither a bounce, nor a hand that is away for a blink", () => {
    const hand = explorer();
    hand.said.length = 0;
    for (let i = 0; i < 600; i++) {
      hand.nowMs += 16;
      hand.tell(i % 9 < 5 ? FLAGS.TOUCHING : 0);
    }
    hand.listen();
    assert.deepEqual(hand.said, []);
  });

  test("is announced as it is when its turn comes", () => {
    const hand = explorer();
    hand.page.say("A long sentence that takes two seconds to be spoken.");
    hand.said.length = 0;
    hand.down = false;
    hand.rest(600);
    hand.down = true;
    hand.listen();
    assert.ok(!hand.said.includes("In the air."), hand.said.join("\n"));
  });
});

describe("a limit", () => {
  const limited = (hand: Explorer, ticks: number, flags: number): void => {
    for (let i = 0; i < ticks; i++) {
      hand.nowMs += 16;
      hand.tell(FLAGS.TOUCHING | flags);
    }
  };

  test("says what it did, once a touch", () => {
    const hand = explorer();
    hand.said.length = 0;
    limited(hand, 30, FLAGS.FORCE_LIMITED);
    limited(hand, 30, 0);
    limited(hand, 30, FLAGS.FORCE_LIMITED);
    hand.listen();
    assert.deepEqual(hand.said, ["The surface would push harder here; the force is held at 1.5 newtons."]);
  });

  test("that is over before its turn is not announced", () => {
    const hand = explorer();
    hand.page.say("A long sentence that takes two seconds to be spoken.");
    hand.said.length = 0;
    limited(hand, 30, FLAGS.DAMPED);
    hand.listen();
    assert.deepEqual(hand.said, []);
  });
});

describe("describing while the hand moves", () => {
  test("tells edges in the air, and rises and falls", () => {
    const slope = house();
    slope.heights_m = slope.heights_m.map((each, k) => each + 0.0001 * Math.min(20, k % COLUMNS));
    const hand = new Explorer(sceneOf(slope));
    hand.put(-0.039, 0.02);
    hand.rest(3000);
    hand.hold("ArrowRight");
    hand.listen();
    assert.deepEqual(hand.said.splice(0), ["In the air."]);
    hand.narrator.moves = true;
    hand.put(-0.039, 0.02);
    hand.rest(3000);
    hand.hold("ArrowRight");
    hand.listen();
    assert.equal(hand.said[0], "What the hand moves over is described.");
    assert.match(hand.said.join(" "), /Rises by 0\.8 mm to 0\.9 mm\. .*Up 2\.3 mm: door, wood\. Down 2\.0 mm: wall, stone\./);
    hand.narrator.moves = false;
  });
});

describe("the tour", () => {
  test("leads the hand from near to far, with name, place and height, and ends", () => {
    const hand = explorer();
    hand.said.length = 0;
    hand.narrator.toggleTour();
    assert.ok(hand.narrator.touring);
    hand.rest(9000 + 4 * STAY_MS + 9000);
    assert.deepEqual(hand.said, [
      "A tour of 3 parts, from near to far. Escape ends it.",
      "knob; in the middle; 3.0 mm high; metal.",
      "door; top; 2.0 mm high; wood.",
      "wall; upper right; 0.0 mm high; stone.",
      "That was the last part of the tour.",
    ]);
    assert.ok(!hand.narrator.touring);
    assert.equal(hand.scene.part(hand.at[0], hand.at[1]), "wall");
  });

  test("leads a motor's hand by a beacon, and lets it go at the end", () => {
    const hand = explorer();
    hand.hub.tell("loop", { event: "loop", at_s: 0, running: true, why: "", own_hand: false });
    hand.narrator.toggleTour();
    hand.rest(5000);
    hand.narrator.toggleTour();
    assert.deepEqual(hand.asked, [["beacon", { part: 2 }], ["beacon", { part: null }]]);
    hand.said.length = 0;
    hand.rest(20_000);
    assert.deepEqual(hand.said.filter((each) => each.includes("door")), []);
  });

  test("ends when forces are stopped", () => {
    const hand = explorer();
    hand.narrator.toggleTour();
    hand.hub.tell("loop", { event: "loop", at_s: 0, running: false, why: "", stopped: true });
    assert.ok(!hand.narrator.touring);
  });
});
