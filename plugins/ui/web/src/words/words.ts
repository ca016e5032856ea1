/** The page's texts in the languages it speaks: tables of [English, German], one file each area, in this folder. */
import { recall, remember } from "../preferences";

export type Table = Record<string, readonly [english: string, german: string]>;
export const LANGUAGES = ["en", "de"] as const;
export type Language = (typeof LANGUAGES)[number];

const KEPT = "language";

export const language: Language = chosen();

/** Which language the page is in: the one that was chosen, or the first of the browser's that it speaks, or English. */
function chosen(): Language {
  const browsers = globalThis.navigator?.languages ?? []; // tests run without a browser
  const wanted = [recall(KEPT, ""), ...browsers.map((each) => each.slice(0, 2))];
  return wanted.find(isLanguage) ?? LANGUAGES[0];
}

function isLanguage(text: string): text is Language {
  return (LANGUAGES as readonly string[]).includes(text);
}

/** Speak another language from now on: the page loads again. */
export function speak(other: Language): void {
  remember(KEPT, other);
  location.reload();
}

/** Every table of texts that was loaded. */
export const tables: Table[] = [];

/** A table as a function: t("opened", { name }) puts values in for {name}. */
export interface Words<T extends Table> {
  (key: keyof T, values?: Record<string, string | number>): string;
  /** Whether there is a text for what the program names. */
  has(name: string): name is keyof T & string;
}

export function words<T extends Table>(table: T): Words<T> {
  tables.push(table);
  const column = LANGUAGES.indexOf(language);
  const t = (key: keyof T, values: Record<string, string | number> = {}): string =>
    table[key]![column]!.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
  return Object.assign(t, { has: (name: string): name is keyof T & string => Object.hasOwn(table, name) });
}

/** A number as the language writes it. */
export function decimal(value: number, digits: number): string {
  return value.toLocaleString(language, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}
