/** The page's texts in the languages it speaks: tables of [English, German], one file each area, in this folder. */

export type Table = Record<string, readonly [english: string, german: string]>;
export const LANGUAGES = ["en", "de"] as const;
export type Language = (typeof LANGUAGES)[number];

const KEPT = "language";

export const language: Language = chosen();

/** Which language the page is in: the one that was chosen, or the browser's, or English. */
function chosen(): Language {
  const wanted = [kept(), ...navigator.languages.map((each) => each.slice(0, 2))];
  return LANGUAGES.find((each) => wanted.includes(each) && each === wanted.find((one) => isLanguage(one))) ?? "en";
}

function isLanguage(text: string): text is Language {
  return (LANGUAGES as readonly string[]).includes(text);
}

function kept(): string {
  try {
    return localStorage.getItem(KEPT) ?? "";
  } catch {
    return "";
  }
}

/** Speak another language from now on: the page loads again. */
export function speak(other: Language): void {
  localStorage.setItem(KEPT, other);
  location.reload();
}

/** A table as a function: t("opened", { name }) puts values in for {name}. */
export function words<T extends Table>(table: T): (key: keyof T, values?: Record<string, string | number>) => string {
  const column = LANGUAGES.indexOf(language);
  return (key, values = {}) =>
    table[key]![column]!.replace(/\{(\w+)\}/g, (whole, name: string) => String(values[name] ?? whole));
}
