/** The page's sources as text, for tests that read them. */
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";

function web(from: string): string {
  return existsSync(join(from, "build.mjs")) ? from : web(dirname(from));
}

const SRC = join(web(import.meta.dirname), "src");

export function sources(folder: string, ending: string): { name: string; text: string }[] {
  return readdirSync(join(SRC, folder), { recursive: true, encoding: "utf8" })
    .filter((name) => name.endsWith(ending))
    .map((name) => ({ name: join(folder, name), text: readFileSync(join(SRC, folder, name), "utf8") }));
}
