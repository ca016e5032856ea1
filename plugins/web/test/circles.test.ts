import assert from "node:assert/strict";
import { test } from "node:test";
import { circles, imports } from "./circles";
import { FOLDERS, sources } from "./sources";

const files = sources(".ts");

test("imports of the sources, types included, have no circle", () => {
  assert.ok(files.length > 100);
  assert.deepEqual(circles(imports(files)), []);
});

test("a page stands on the kit alone, and the kit on no page", () => {
  const home = (name: string): string => FOLDERS.find((folder) => name.startsWith(`${folder}/`))!;
  for (const [name, targets] of imports(files))
    for (const target of targets) assert.ok([home(name), "web/kit"].includes(home(target)), `${name} imports ${target}`);
});

test("a type import that closes a circle is found", () => {
  const fault = files.map((file) => (file.name === "web/kit/page.ts" ? { ...file, text: `import type { Hand } from "./hand/hand";\n${file.text}` } : file));
  const [found] = circles(imports(fault));
  assert.ok(found?.includes("web/kit/page.ts") && found.includes("web/kit/hand/hand.ts"), String(found));
});

test("a dynamic import and a re-export count as imports", () => {
  const graph = imports([
    { name: "a.ts", text: 'const b = () => import("./b");' },
    { name: "b.ts", text: 'export { c } from "./c/c";' },
    { name: "c/c.ts", text: 'import type {\n  A,\n} from "../a";' },
  ]);
  assert.deepEqual(circles(graph), [["a.ts", "b.ts", "c/c.ts"]]);
});

test("an import of a file that is not there is an error", () => {
  assert.throws(() => imports([{ name: "a.ts", text: 'import "./missing";' }]), /missing/);
});
