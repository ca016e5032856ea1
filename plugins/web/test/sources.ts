/** The pages' sources as text, for tests that read them. */
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

/** The folder `plugins`, which run.mjs fills in. */
declare const PLUGINS: string;

/** Folders of the sources, below `plugins`: what the pages share, and each of them. */
export const FOLDERS = ["web/kit", "ui/web/src", "send/web", "study/web"];

/** Return the files of a folder below `plugins`, by default of all that pages are made of. */
export function sources(ending: string, folders = FOLDERS): { name: string; text: string }[] {
  return folders.flatMap((folder) =>
    readdirSync(join(PLUGINS, folder), { recursive: true, encoding: "utf8" })
      .filter((name) => name.endsWith(ending))
      .map((name) => ({ name: join(folder, name), text: readFileSync(join(PLUGINS, folder, name), "utf8") })),
  );
}
