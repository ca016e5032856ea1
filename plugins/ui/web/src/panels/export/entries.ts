/** Entries of the `export` key: a list of names, or of blocks with options. */
import type { Plain } from "kit/server/messages";
import { isMap, same } from "../../forms/values";

export interface Entry {
  use: string;
  options: { [name: string]: Plain };
  on: boolean;
}

/** Return an entry for every exporter, more if the file lists it more often; the file's entries are on. */
export function entriesOf(value: Plain | undefined, names: string[]): Entry[] {
  const given = parseEntries(value);
  const known = [...names, ...given.map(({ use }) => use).filter((use) => !names.includes(use))];
  return [...new Set(known)].flatMap((use) => {
    const those = given.filter((each) => each.use === use);
    return those.length ? those : [{ use, options: {}, on: false }];
  });
}

/** Return the entries that are on, in the shortest form of the file. */
export function blocksOf(entries: Entry[]): Plain[] {
  return entries.filter(({ on }) => on).map(({ use, options }) => (Object.keys(options).length ? { use, ...options } : use));
}

/** Return whether the file lists the same exports already, in any form. */
export function equals(value: Plain | undefined, blocks: Plain[]): boolean {
  return same(blocksOf(parseEntries(value)), blocks);
}

function parseEntries(value: Plain | undefined): Entry[] {
  const all = Array.isArray(value) ? value : value === undefined || value === null ? [] : [value];
  return all.flatMap((each) => {
    if (typeof each === "string") return [{ use: each, options: {}, on: true }];
    if (!isMap(each) || typeof each.use !== "string") return [];
    const { use, ...options } = each;
    return [{ use, options, on: true }];
  });
}
