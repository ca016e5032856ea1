/** Fuzzy matching: the letters of what was typed, in their order, the more of them together and at starts of words the better. */

const TOGETHER = 3;
const AT_START = 4;
/** Cost of a letter that was passed over. */
const PASSED = 0.05;

/** Return a text in small letters without accents. */
export function plain(text: string): string {
  return text.normalize("NFD").replace(/\p{M}/gu, "").replace(/ß/g, "ss").toLowerCase();
}

/** Return how well a text matches, higher is better; null if it does not: every word of the query must be in it. */
export function score(query: string, text: string): number | null {
  const into = plain(text);
  let sum = 0;
  for (const word of plain(query).split(/\s+/).filter(Boolean)) {
    const found = scoreWord(word, into);
    if (found === null) return null;
    sum += found;
  }
  return sum;
}

/** A letter counts most where a word starts; each start of the text's words is tried, and the best is taken. */
function scoreWord(word: string, text: string): number | null {
  let best: number | null = null;
  for (let from = text.indexOf(word[0]!); from >= 0; from = text.indexOf(word[0]!, from + 1)) {
    const found = walk(word, text, from);
    if (found !== null && (best === null || found > best)) best = found;
  }
  return best;
}

function walk(word: string, text: string, from: number): number | null {
  let sum = 0;
  let before = from - 1;
  for (const [at, letter] of [...word].entries()) {
    const place = at === 0 ? from : text.indexOf(letter, before + 1);
    if (place < 0) return null;
    sum += 1 + (place === before + 1 && at > 0 ? TOGETHER : 0) + (isStart(text, place) ? AT_START : 0) - PASSED * (place - before - 1);
    before = place;
  }
  return sum;
}

const isStart = (text: string, at: number): boolean => at === 0 || /[^\p{L}\p{N}]/u.test(text[at - 1]!);

/** Share of the best score that an item needs: others have the letters somewhere, and not what was meant. */
const NEAR = 0.7;

/** Return the items that match, the best first; equal ones keep their order. texts: of an item, the leading one first. */
export function ranked<T>(query: string, items: readonly T[], texts: (item: T) => readonly string[]): T[] {
  if (!query.trim()) return [...items];
  const found: { item: T; best: number }[] = [];
  for (const item of items) {
    const scores = texts(item).map((text, at) => (score(query, text) ?? -Infinity) - at);
    const best = Math.max(...scores);
    if (best > -Infinity) found.push({ item, best });
  }
  found.sort((a, b) => b.best - a.best);
  return found.filter(({ best }) => best >= NEAR * found[0]!.best).map(({ item }) => item);
}
