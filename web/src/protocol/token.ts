// The token is in the link's fragment, which browsers do not send; it is then kept for this tab only. So is a view that the link opens.
const key = "talus-token";
const viewKey = "talus-linked-view";

export function takeToken(): string {
  const parameters = new URLSearchParams(location.hash.slice(1));
  const inLink = parameters.get("token");
  const view = parameters.get("view");
  if (view !== null) sessionStorage.setItem(viewKey, view);
  if (inLink !== null && inLink !== "") {
    sessionStorage.setItem(key, inLink);
    history.replaceState(null, "", location.pathname + location.search);
    return inLink;
  }
  return sessionStorage.getItem(key) ?? "";
}

/** The view that the link opens, once; null: none. */
export function takeLinkedView(): string | null {
  const view = sessionStorage.getItem(viewKey);
  sessionStorage.removeItem(viewKey);
  return view;
}

/** Loads the page again, with this view. */
export function reloadWith(view: string): void {
  sessionStorage.setItem(viewKey, view);
  location.reload();
}

/** view: empty, or what it opens besides the session. */
export function linkWith(token: string, view = ""): string {
  return `${location.origin}${location.pathname}#token=${token}${view === "" ? "" : `&view=${view}`}`;
}
