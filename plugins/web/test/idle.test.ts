import assert from "node:assert/strict";
import { test } from "node:test";
import { Hub } from "kit/hub";
import { whenIdle } from "kit/server/idle";
import type { Events } from "kit/server/messages";

/** Whether there is time by now, of a page that heard this. */
async function begun(...said: { [K in keyof Events]: [K, Partial<Events[K]>] }[keyof Events][]): Promise<boolean> {
  const hub = new Hub();
  let there = false;
  void whenIdle(hub).then(() => (there = true));
  for (const [name, event] of said) hub.tell(name, event as never);
  await Promise.resolve();
  return there;
}

test("what nobody waits for is asked for once a surface is felt", async () => {
  assert.equal(await begun(), false);
  assert.equal(await begun(["document", { complaints: [] }], ["scene", {}]), false);
  assert.equal(await begun(["made", { want: "touch", outcome: "made" }]), false);
  assert.equal(await begun(["touch", {}]), true);
});

test("or where nothing comes to be felt", async () => {
  assert.equal(await begun(["made", { want: "touch", outcome: "failed" }]), true);
  assert.equal(await begun(["made", { want: "relief", outcome: "made" }]), true);
  assert.equal(await begun(["document", { complaints: [{} as never] }]), true);
  assert.equal(await begun(["maker_gone", {}]), true);
});

test("or after a while with a program that says nothing", async () => {
  const hub = new Hub();
  const begun = whenIdle(hub, 1);
  hub.tell("hello", {} as never);
  await begun;
});
