/** What is to be exported, as the pipeline file says it: a list of names, or of blocks with options. */
import type { Plain } from "../../forms/schema";
import { isMap, same } from "../../forms/values";

export interface Entry {
  use: string;
  options: { [name: string]: Plain };
  on: boolean;
}

/** Every exporter once, more often where the file says it more often; those that the file says are on. */
export function entriesOf(said: Plain | undefined, names: string[]): Entry[] {
  const given = parseEntries(said);
  const known = [...names, ...given.map(({ use }) => use).filter((use) => !names.includes(use))];
  return [...new Set(known)].flatMap((use) => {
    const those = given.filter((each) => each.use === use);
    return those.length ? those : [{ use, options: {}, on: false }];
  });
}

/** Those that are on, as short as the file can say them. */
export function blocksOf(entries: Entry[]): Plain[] {
  return entries.filter(({ on }) => on).map(({ use, options }) => (Object.keys(options).length ? { use, ...options } : use));
}

/** Whether the file says the same already, in whatever words. */
export function equals(said: Plain | undefined, blocks: Plain[]): boolean {
  return same(blocksOf(parseEntries(said)), blocks);
}

function parseEntries(said: Plain | undefined): Entry[] {
  const all = Array.isArray(said) ? said : said === undefined || said === null ? [] : [said];
  return all.flatMap((each) => {
    if (typeof each === "string") return [{ use: each, options: {}, on: true }];
    if (!isMap(each) || typeof each.use !== "string") return [];
    const { use, ...options } = each;
    return [{ use, options, on: true }];
  });
}
