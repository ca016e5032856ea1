/** The key that the page's address holds: taken out of it, so that neither the address bar nor a bookmark shows it. */
const KEPT = "key";

export const token = taken();

/** A reload finds it again; in a browser that keeps nothing it stays in the address. */
function taken(): string {
  const address = new URL(location.href);
  const said = address.searchParams.get("token");
  try {
    if (said === null) return sessionStorage.getItem(KEPT) ?? "";
    sessionStorage.setItem(KEPT, said);
    address.searchParams.delete("token");
    history.replaceState(history.state, "", address);
  } catch {
    // it is used as it was said
  }
  return said ?? "";
}
