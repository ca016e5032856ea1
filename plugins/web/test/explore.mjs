// Explores pictures by keys with the page's own narration: `node test/explore.mjs < PICTURES > ANNOUNCEMENTS`, both JSON.
// In: {"strokes": 60, "pictures": [...]} (test/speech/exploration.ts). Out: for each picture, all that was announced.
import { rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { text } from "node:stream/consumers";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";

const outfile = join(import.meta.dirname, `../node_modules/.explore-${process.pid}.mjs`);
try {
  await build({
    entryPoints: [join(import.meta.dirname, "speech/exploration.ts")],
    outfile, bundle: true, packages: "external", platform: "node", format: "esm", target: "es2022",
    loader: { ".css": "empty" }, logLevel: "warning",
  });
  const { explore } = await import(pathToFileURL(outfile).href);
  const { strokes, pictures } = JSON.parse(await text(process.stdin));
  writeFileSync(1, JSON.stringify(pictures.map((each) => explore(each, strokes))));
} finally {
  rmSync(outfile, { force: true });
}
