import assert from "node:assert/strict";
import { beforeEach, describe, test } from "node:test";
import { AGAIN_MS, Announcer, LETTER_MS, LONGEST_PAUSE_MS, PAUSE_MS, STALE_MS } from "kit/speech/announcer";

let now = 0;
let due: { atMs: number; act: () => void }[] = [];
let said: string[] = [];
let saidMs: number[] = [];
let announcer: Announcer;

/** Let time pass, and what is due happen. */
function pass(ms: number): void {
  for (const end = now + ms; ; ) {
    const next = due.filter(({ atMs }) => atMs <= end).sort((a, b) => a.atMs - b.atMs)[0];
    if (!next) return void (now = end);
    due = due.filter((each) => each !== next);
    now = Math.max(now, next.atMs);
    next.act();
  }
}

beforeEach(() => {
  now = 0;
  [due, said, saidMs] = [[], [], []];
  const clock = { now: () => now, after: (ms: number, act: () => void) => void due.push({ atMs: now + ms, act }) };
  announcer = new Announcer(({ text }) => (said.push(text), saidMs.push(now)), clock);
});

describe("what is said", () => {
  test("the first at once, the next a second later", () => {
    for (const text of ["a", "b", "c"]) announcer.say(text);
    assert.deepEqual(said, ["a"]);
    pass(PAUSE_MS);
    assert.deepEqual(said, ["a", "b"]);
    pass(PAUSE_MS);
    assert.deepEqual(said, ["a", "b", "c"]);
  });

  test("never more than one a second, however much changes", () => {
    for (let i = 0; i < 600; i++) {
      announcer.say(i % 7 ? `wood ${i % 3}` : "in the air", { topic: "contact" });
      announcer.say(`limit ${i}`);
      pass(16);
    }
    pass(20_000);
    const pauses = saidMs.slice(1).map((each, i) => each - saidMs[i]);
    assert.ok(Math.min(...pauses) >= PAUSE_MS);
    assert.ok(said.length > 9);
  });

  test("of a topic the newest alone", () => {
    announcer.say("making", { topic: "status" });
    announcer.say("wood", { topic: "contact" });
    announcer.say("felt", { topic: "contact" });
    announcer.say("brick", { topic: "contact" });
    pass(10_000);
    assert.deepEqual(said, ["making", "brick"]);
  });

  test("what came back to what was said is not said", () => {
    announcer.say("wood", { topic: "contact" });
    announcer.say("brick", { topic: "contact" });
    announcer.say("wood", { topic: "contact" });
    pass(20_000);
    announcer.say("wood", { topic: "contact" });
    pass(20_000);
    assert.deepEqual(said, ["wood"]);
  });

  test("the same sentence again only after a while", () => {
    announcer.say("the disk is full");
    pass(AGAIN_MS - 1);
    announcer.say("the disk is full");
    assert.equal(said.length, 1);
    pass(1);
    announcer.say("the disk is full");
    assert.equal(said.length, 2);
  });

  test("what waited too long is stale, but no error is", () => {
    for (let i = 0; i < 9; i++) announcer.say(`event ${i}`);
    announcer.say("error", { urgent: true });
    pass(PAUSE_MS);
    assert.deepEqual(said, ["event 0", "error"]);
    pass(60_000);
    assert.ok(!said.includes("event 8"));
    assert.ok(saidMs.at(-1)! <= STALE_MS);
  });

  test("errors stand in their order", () => {
    for (const text of ["a", "b"]) announcer.say(text);
    for (const text of ["x", "y"]) announcer.say(text, { urgent: true });
    pass(10_000);
    assert.deepEqual(said, ["a", "x", "y", "b"]);
  });

  test("what a person asks for is said at once and again, and ends what waited", () => {
    for (const text of ["a", "b"]) announcer.say(text);
    announcer.say("here", { topic: "where", asked: true });
    announcer.say("here", { topic: "where", asked: true });
    assert.deepEqual(said, ["a", "here", "here"]);
    pass(10_000);
    assert.deepEqual(said, ["a", "here", "here"]);
  });

  test("what is forgotten may be said again", () => {
    announcer.say("at its limit", { topic: "limit" });
    announcer.forget("limit");
    pass(PAUSE_MS);
    announcer.say("at its limit", { topic: "limit" });
    assert.equal(said.length, 2);
  });

  test("nothing while it is hushed, and nothing empty", () => {
    announcer.muted = true;
    announcer.say("long over");
    announcer.muted = false;
    announcer.say("");
    pass(10_000);
    assert.deepEqual(said, []);
  });

  test("a text that comes later is composed when its turn comes, and left out if it is no longer true", () => {
    let touching = true;
    announcer.say("a");
    announcer.say(() => (touching ? "Touching wood." : ""), { topic: "contact" });
    announcer.say("b");
    touching = false;
    pass(PAUSE_MS);
    assert.deepEqual(said, ["a", "b"]);
    touching = true;
    announcer.say(() => (touching ? "Touching wood." : ""), { topic: "contact" });
    pass(PAUSE_MS);
    assert.deepEqual(said, ["a", "b", "Touching wood."]);
  });

  test("a long sentence is spoken to its end, but the stop does not wait", () => {
    const long = "x".repeat(60);
    announcer.say(long);
    announcer.say("next");
    pass(60 * LETTER_MS - 1);
    assert.deepEqual(said, [long]);
    pass(1);
    assert.deepEqual(said, [long, "next"]);
    pass(PAUSE_MS);
    announcer.say("y".repeat(999));
    announcer.say("error", { urgent: true });
    announcer.say("last");
    pass(PAUSE_MS);
    assert.equal(said.at(-1), "error");
    pass(PAUSE_MS);
    assert.equal(said.at(-1), "last");
    assert.ok(LONGEST_PAUSE_MS < STALE_MS);
  });

  test("paths and modules are not spelled out", () => {
    announcer.say("tangible_core.files: /home/ada/x/cat.yaml is saved");
    assert.deepEqual(said, ["cat.yaml is saved"]);
  });
});
