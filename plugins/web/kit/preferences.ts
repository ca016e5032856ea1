/** Preferences of the person, kept in this browser: widths, open panels, theme. Nothing else depends on them. */

const BEFORE = "tangible.";

/** Return the value kept under a name if it has the type of the default, else the default. */
export function recall<T extends string | number | boolean>(name: string, otherwise: T): T {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(BEFORE + name) ?? "null");
    return typeof kept === typeof otherwise ? (kept as T) : otherwise;
  } catch {
    return otherwise; // no storage, as in a private window, or a foreign value
  }
}

export function remember(name: string, value: string | number | boolean): void {
  try {
    localStorage.setItem(BEFORE + name, JSON.stringify(value));
  } catch {
    // no storage, or a full one: the value holds until the page is closed
  }
}
