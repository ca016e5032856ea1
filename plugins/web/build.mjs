// Bundles the pages: `node build.mjs [FOLDER] [--watch]`, without a folder into the Python package beside this file. What
// they share is in `kit`; each page is the folder `web` of its plugin: that of `tangible ui`, in pieces; the one that is
// sent to others, `send.js` and `send.css`, and that of a participant of a study, `study.js` and `study.css`, each whole.
// A folder is replaced whole or not at all: a build that fails or is killed leaves the page of before, or none.
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, relative, resolve, sep } from "node:path";
import { build, context } from "esbuild";

const WEB = import.meta.dirname;
const PLUGINS = dirname(WEB);
const UI = join(PLUGINS, "ui/web");
const UNTOUCHED = new Set(["node_modules", "test", "tangible_web"]);
const FREE = /^(MIT|ISC|Zlib|0BSD|BSD-[23]-Clause|Apache-2\.0)$/;

const words = process.argv.slice(2);
const watching = words.includes("--watch");
const out = resolve(words.find((word) => !word.startsWith("--")) ?? join(WEB, "tangible_web/static"));

/** Every file that the pages are made of; hatch_build.py has the same rule. */
function sources() {
  const pages = readdirSync(PLUGINS).map((plugin) => join(PLUGINS, plugin, "web"));
  return [WEB, ...pages.filter((folder) => existsSync(folder))].flatMap((folder) => within(folder, UNTOUCHED));
}

function within(folder, untouched = new Set()) {
  return readdirSync(folder, { withFileTypes: true })
    .filter(({ name }) => !name.startsWith(".") && !untouched.has(name))
    .flatMap((entry) => (entry.isDirectory() ? within(join(folder, entry.name)) : [join(folder, entry.name)]));
}

function digests() {
  const digest = (path) => createHash("sha256").update(readFileSync(path)).digest("hex");
  return Object.fromEntries(sources().map((path) => [relative(PLUGINS, path).split(sep).join("/"), digest(path)]));
}

/** The licence of every package of which something is in the bundle. */
function licences(inputs) {
  const folders = Object.keys(inputs).map((path) => path.match(/^.*node_modules\/(?:@[^/]+\/)?[^/]+/)?.[0]);
  return [...new Set(folders.filter(Boolean))].sort().map((folder) => {
    const { name, version, license } = JSON.parse(readFileSync(join(WEB, folder, "package.json"), "utf8"));
    if (!FREE.test(license)) throw new Error(`${name} may not be bundled: its licence is ${license}`);
    const file = readdirSync(join(WEB, folder)).find((each) => /^licen[cs]e/i.test(each));
    if (!file) throw new Error(`${name} brings no text of its licence`);
    return `${name} ${version} (${license})\n\n${readFileSync(join(WEB, folder, file), "utf8")}`;
  });
}

function replace(files) {
  mkdirSync(dirname(out), { recursive: true });
  const work = mkdtempSync(`${out}-`);
  const fresh = join(work, "new");
  try {
    mkdirSync(fresh);
    for (const [name, contents] of Object.entries(files)) writeFileSync(join(fresh, name), contents);
    try {
      renameSync(out, join(work, "old"));
    } catch (error) {
      if (error.code !== "ENOENT") throw error;
    }
    renameSync(fresh, out);
  } finally {
    rmSync(work, { recursive: true, force: true });
  }
}

/** The page with what its script imports at once: a browser asks for all of it together, not for one after the other. */
function preloading(html, outputs) {
  const app = Object.entries(outputs).find(([path]) => path.endsWith("app.js"))[1];
  const needed = app.imports.filter(({ kind }) => kind === "import-statement").map(({ path }) => path.split("/").at(-1));
  const links = needed.map((name) => `<link rel="modulepreload" href="${name}">\n`);
  return html.replace("</head>", `${links.join("")}</head>`);
}

async function finish({ outputFiles, metafile }) {
  const made = Object.fromEntries([...outputFiles, ...(await whole())].map(({ path, contents }) => [relative(out, path), contents]));
  const legal = Object.keys(made).filter((name) => name.endsWith(".LEGAL.txt"));
  const texts = [...licences(metafile.inputs), ...legal.map((name) => Buffer.from(made[name]).toString())];
  for (const name of legal) delete made[name];
  made["index.html"] = preloading(readFileSync(join(UI, "index.html"), "utf8"), metafile.outputs);
  made["LICENSES.txt"] = texts.join(`\n${"-".repeat(80)}\n\n`);
  made["built.json"] = JSON.stringify(watching ? {} : digests(), null, 1);
  replace(made);
}

async function finishAgain(result) {
  if (result.errors.length) return;
  try {
    await finish(result);
    console.log(`${new Date().toLocaleTimeString()} built`);
  } catch (error) {
    console.error(error.message);
  }
}

const page = {
  name: "page",
  setup(builder) {
    builder.onResolve({ filter: /^the page$/ }, () => ({ path: "app", namespace: "page" }));
    builder.onLoad({ filter: /.*/, namespace: "page" }, () => ({
      contents: 'import "./src/main.ts";',
      resolveDir: UI,
      watchFiles: [join(UI, "index.html")],
    }));
    if (watching) builder.onEnd(finishAgain);
  },
};

/** The pages that are one file: each with one script that needs no other. */
async function whole() {
  const { outputFiles } = await build({
    ...options, entryPoints: { send: "../send/web/main.ts", study: "../study/web/main.ts" }, splitting: false, format: "iife", legalComments: "none", plugins: [],
    minify: true, sourcemap: false,
  });
  return outputFiles;
}

const options = {
  absWorkingDir: WEB,
  entryPoints: { app: "the page" },
  outdir: out,
  bundle: true,
  splitting: true, // what a panel imports when it is opened is a file of its own
  chunkNames: "[name]-[hash]",
  minify: !watching,
  sourcemap: watching && "inline",
  format: "esm",
  target: "es2022",
  legalComments: "external",
  logLevel: "warning",
  metafile: true,
  write: false,
  plugins: [page],
};

if (watching) await (await context(options)).watch();
else
  try {
    await finish(await build(options));
  } catch (error) {
    if (!error.errors) console.error(error.message); // what esbuild found, it has printed
    process.exitCode = 1;
  }
