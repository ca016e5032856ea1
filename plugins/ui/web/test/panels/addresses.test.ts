import assert from "node:assert/strict";
import { before, describe, test } from "node:test";

const NAMES = ["a.stl", "50 % #1?.stl", "a%23b.stl", "100%25&x=1.stl", "Grüße/../b.stl"];

/** Return the last part of an address as the server reads it, and its key. */
function read(address: string): [name: string, token: string | null, hash: string] {
  const { pathname, searchParams, hash } = new URL(address, "http://localhost");
  return [decodeURIComponent(pathname.split("/").slice(3).join("/")), searchParams.get("token"), hash];
}

describe("addresses of files", () => {
  const opened: string[] = [];

  before(() => {
    Object.assign(globalThis, { location: { href: "http://localhost/?token=a%2Fb%25%23" }, history: { replaceState: () => undefined } });
    Object.assign(globalThis, { sessionStorage: { getItem: () => null, setItem: () => undefined } });
    class Request {
      readonly status = 204;
      readonly upload = {};
      onload = (): void => undefined;
      open(_: string, address: string): void {
        opened.push(address);
      }
      send(): void {
        this.onload();
      }
    }
    Object.assign(globalThis, { XMLHttpRequest: Request });
  });

  test("exported file of any name is found, with the page's key", async () => {
    const { address } = await import("../../src/panels/export/outcomes");
    for (const name of NAMES) assert.deepEqual(read(address("export-1", name)), [name, "a/b%#", ""], name);
  });

  test("uploaded file keeps its name, whatever it is", async () => {
    const { uploadAndOpen } = await import("../../src/panels/open/upload");
    const net = { ask: async (name: string) => (name === "batch" ? "0123" : {}) } as never;
    await uploadAndOpen(net, NAMES.map((name) => new File(["x"], name)), () => undefined);
    assert.deepEqual(opened.map(read), NAMES.map((name) => [name, "a/b%#", ""]));
  });
});
