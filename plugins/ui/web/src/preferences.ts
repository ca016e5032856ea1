/** What this browser remembers of how a person has the page: widths, open panels, theme. Nothing depends on it. */

const BEFORE = "tangible.";

/** What was remembered under a name, if it is of the kind of what stands for it otherwise. */
export function recall<T extends string | number | boolean>(name: string, otherwise: T): T {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(BEFORE + name) ?? "null");
    return typeof kept === typeof otherwise ? (kept as T) : otherwise;
  } catch {
    return otherwise; // no storage, as in a private window, or not ours
  }
}

export function remember(name: string, value: string | number | boolean): void {
  try {
    localStorage.setItem(BEFORE + name, JSON.stringify(value));
  } catch {
    // no storage, or a full one: it holds until the page is closed
  }
}
