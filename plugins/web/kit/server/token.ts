/** The key of the page's address, removed from it so that neither the address bar nor a bookmark shows it. */
const KEPT = "key";

export const token = takeToken();

/** Return the key; a reload finds it in the session's storage, or else in the address. */
function takeToken(): string {
  const address = new URL(location.href);
  const text = address.searchParams.get("token");
  try {
    if (text === null) return sessionStorage.getItem(KEPT) ?? "";
    sessionStorage.setItem(KEPT, text);
    address.searchParams.delete("token");
    history.replaceState(history.state, "", address);
  } catch {
    // without storage the address keeps the key
  }
  return text ?? "";
}
