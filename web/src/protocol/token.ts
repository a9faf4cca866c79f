// The token is in the link's fragment, which browsers do not send; it is then kept for this tab only.
const key = "talus-token";

export function takeToken(): string {
  const inLink = new URLSearchParams(location.hash.slice(1)).get("token");
  if (inLink !== null && inLink !== "") {
    sessionStorage.setItem(key, inLink);
    history.replaceState(null, "", location.pathname + location.search);
    return inLink;
  }
  return sessionStorage.getItem(key) ?? "";
}

export function linkWith(token: string): string {
  return `${location.origin}${location.pathname}#token=${token}`;
}
