// Bundles the page into ../tangible_ui/static, with the licences of what is in it.
import { build } from "esbuild";
import { cpSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";

const out = "../tangible_ui/static";
mkdirSync(out, { recursive: true });
const { metafile } = await build({
  entryPoints: ["src/main.ts"], outfile: `${out}/app.js`, bundle: true, minify: true, format: "esm", target: "es2022",
  legalComments: "none", metafile: true,
});
for (const name of ["index.html"]) cpSync(name, `${out}/${name}`);
const inside = new Set(Object.keys(metafile.inputs).flatMap((path) => path.match(/node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1] ?? []));
writeFileSync(`${out}/LICENSES.txt`, [...inside].map((name) => `${name}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8")}`).join("\n\n"));
