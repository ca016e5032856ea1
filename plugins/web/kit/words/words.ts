/** Texts of the page: tables of [English, German, French], one per area, next to the code that uses them.
 * Of a plugin's table without French, the English is shown. */
import { recall, remember } from "../preferences";

export type Table = Record<string, readonly [english: string, german: string, french?: string]>;
export const LANGUAGES = ["en", "de", "fr"] as const;
export type Language = (typeof LANGUAGES)[number];

const KEPT = "language";

export const language: Language = chosen();

/** Return the language that the page was made for, or the chosen one, or the browser's first supported one, or English. */
function chosen(): Language {
  const browsers = globalThis.navigator?.languages ?? []; // tests run without a browser
  const fixed = globalThis.document?.documentElement?.dataset?.language ?? "";
  const wanted = [fixed, recall(KEPT, ""), ...browsers.map((each) => each.slice(0, 2))];
  return wanted.find(isLanguage) ?? LANGUAGES[0];
}

function isLanguage(text: string): text is Language {
  return (LANGUAGES as readonly string[]).includes(text);
}

/** Switch the language; the page reloads. */
export function speak(other: Language): void {
  remember(KEPT, other);
  location.reload();
}

/** Tables of texts loaded so far. */
export const tables: Table[] = [];

/** A table as a function: t("opened", { name }) fills in {name}. */
export interface Words<T extends Table> {
  (key: keyof T, values?: Record<string, string | number>): string;
  /** Return whether the table has a text of this name. */
  has(name: string): name is keyof T & string;
}

export function words<T extends Table>(table: T): Words<T> {
  tables.push(table);
  const column = LANGUAGES.indexOf(language);
  const t = (key: keyof T, values: Record<string, string | number> = {}): string =>
    (table[key]![column] ?? table[key]![0]).replace(/\{(\w+)\}/g, (whole, name: string) => notation(String(values[name] ?? whole)));
  return Object.assign(t, { has: (name: string): name is keyof T & string => Object.hasOwn(table, name) });
}

/** Return a text, with the language's decimal mark if it is a number. */
export function notation(text: string): string {
  return NUMBER.test(text) ? text.replace(".", MARK) : text;
}

const NUMBER = /^[-−]?\d+\.\d+$/;
const MARK = (0.5).toLocaleString(language)[1]!;

/** Return a number in the language's notation. */
export function decimal(value: number, digits: number): string {
  return value.toLocaleString(language, { minimumFractionDigits: digits, maximumFractionDigits: digits });
}
