import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { follow, headline } from "../../src/frame/headline";
import { Hub } from "kit/hub";

/** A hub, and a function that tells it events and returns the sentence after the last. */
function head() {
  const hub = new Hub();
  const facts = follow(hub, () => undefined);
  const after = (...events: [name: string, event?: object][]): string => {
    for (const [name, event] of events) hub.tell(name as never, { event: name, at_s: 0, ...event } as never);
    const { what, text } = headline(facts);
    return `${what}: ${text}`;
  };
  return { after };
}

const OPEN: [string, object?][] = [["hello"], ["holding", { holding: true, free: false }], ["maker"], ["document", { complaints: [], path: "/a.yaml", text: "scene" }]];
const FELT: [string, object?][] = [...OPEN, ["shown"], ["touch", { law: "proxy" }], ["loop", { running: true, why: "" }]];
const STAGE = { product: "disparity", method: "sgm" };

describe("head of the page", () => {
  test("it follows a file from the start until it is felt", () => {
    const { after } = head();
    assert.equal(after(), "idle: Starting");
    assert.equal(after(["hello"]), "idle: Open a picture to begin.");
    assert.equal(after(["opening", { name: "a.svg" }]), "idle: Starting");
    assert.equal(after(["opening", { name: "" }]), "idle: Open a picture to begin.");
    assert.equal(after(...OPEN), "idle: Starting");
    assert.equal(after(["stage", { ...STAGE, done: {} }]), "busy: Computing Disparity with sgm");
    assert.equal(after(["shown"], ["made", { want: "touch", outcome: "made", why: "" }]), "idle: The surface can be seen, not felt yet.");
    assert.equal(after(["touch", { law: "proxy" }], ["loop", { running: true, why: "" }]), "felt: Feeling: proxy");
  });

  test("a first run counts down what is left, and a notice without a time changes nothing", () => {
    const { after } = head();
    const log = (child: string, text: string): [string, object] => ["log", { logger: `tangible_core.compiled.compiling${child}`, text }];
    assert.equal(after(...OPEN, log("", "compiling the depth kernels, about 40 s; later")), "busy: Preparing for this computer, once: about 40 s");
    assert.equal(after(log(".progress", "about 12 s left")), "busy: Preparing for this computer, once: about 12 s");
    assert.equal(after(log("", "compiling the devices kernels, seconds; later")), "busy: Preparing for this computer, once: about 12 s");
  });

  test("a lost connection is said until it is back, and then what is felt, though the server repeats nothing", () => {
    const { after } = head();
    after(...FELT);
    assert.equal(after(["gone"]), "error: No answer; trying again.");
    assert.equal(after(["gone"]), "error: No answer; trying again.");
    assert.equal(after(["hello"], ["holding", { holding: true, free: false }]), "felt: Feeling: proxy");
  });

  test("work that a lost connection interrupted is not said to go on", () => {
    const { after } = head();
    assert.equal(after(...FELT, ["stage", { ...STAGE, done: {} }], ["gone"], ["hello"]), "felt: Feeling: proxy");
  });

  test("work that ends is not a state: what is felt is", () => {
    for (const outcome of ["made", "stopped"]) {
      const { after } = head();
      assert.equal(after(...FELT, ["stage", { ...STAGE, done: {} }], ["made", { want: "relief", outcome, why: "" }]), "felt: Feeling: proxy");
    }
  });

  test("no force comes before work, and work before what is felt", () => {
    const { after } = head();
    assert.equal(after(...FELT, ["loop", { running: false, stopped: true, why: "" }]), "stopped: Stopped: no force.");
    assert.equal(after(["stage", { ...STAGE, done: {} }]), "stopped: Stopped: no force. Computing Disparity with sgm");
    assert.equal(after(["touch", { law: "penalty" }]), "busy: Computing Disparity with sgm");
  });

  test("a fault stays until something else is begun", () => {
    const { after } = head();
    assert.equal(after(...FELT, ["made", { want: "touch", outcome: "failed", why: "no memory" }]), "error: no memory");
    assert.equal(after(["holding", { holding: false, free: false }]), "error: no memory");
    assert.equal(after(["making"]), "idle: Another tab holds the hand.");
    assert.equal(after(["holding", { holding: true, free: false }]), "felt: Feeling: proxy");
  });

  test("another server and a wrong file are said", () => {
    const { after } = head();
    assert.match(after(["gone"], ["refused", { why: "key" }]), /^error: This address belongs to an earlier start/);
    const other = head();
    assert.match(other.after(["hello"], ["document", { complaints: [{}], path: "/a.yaml", text: "scene" }]), /^error: The pipeline file has errors/);
  });
});
