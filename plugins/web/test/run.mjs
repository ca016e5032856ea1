// Runs the pages' own tests with node's test runner: `node test/run.mjs [WORDS FOR node --test]`.
// They are bundled as the page is, so that what is tested is what a browser is given.
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { join } from "node:path";
import { build } from "esbuild";

const TEST = import.meta.dirname;
const PLUGINS = join(TEST, "../..");
const found = (folder, ending) =>
  readdirSync(folder, { recursive: true })
    .filter((name) => name.endsWith(ending))
    .map((name) => join(folder, name));

const outdir = mkdtempSync(join(TEST, "../node_modules/.test-"));
process.exitCode = 1;
try {
  await build({
    entryPoints: ["web", "ui/web"].flatMap((page) => found(join(PLUGINS, page, "test"), ".test.ts")),
    outdir,
    outbase: PLUGINS,
    outExtension: { ".js": ".mjs" },
    bundle: true,
    packages: "external",
    platform: "node",
    format: "esm",
    target: "es2022",
    sourcemap: "inline",
    loader: { ".css": "empty" },
    define: { PLUGINS: JSON.stringify(PLUGINS) },
    logLevel: "warning",
  });
  const words = ["--enable-source-maps", "--test", ...process.argv.slice(2), ...found(outdir, ".mjs")];
  process.exitCode = spawnSync(process.execPath, words, { stdio: "inherit" }).status ?? 1;
} finally {
  rmSync(outdir, { recursive: true, force: true });
}
