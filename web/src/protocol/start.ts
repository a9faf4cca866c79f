// What the start page and the server tell each other: docs/protocol.md, "The start page".
export interface KnownScene {
  id: string;
  title: string;
  kind: "recent" | "own" | "builtin";
  file: string | null;
  opened_at: string | null;
  missing: boolean;
}
export interface SavedSession { id: string; name: string; title: string; saved_at: string; scenarios: number }

export interface StartPage {
  /** False: a server of one scene, which has nothing of the following. */
  available: boolean;
  open: { title: string } | null;
  opening: { what: string; share: number } | null;
  error: string | null;
  /** Sessions opened so far: grows when another one has taken the place. */
  count: number;
  /** About the session that is open. */
  notes: string[];
  program: string;
  role: "viewer" | "controller";
  // For controllers.
  folder?: string;
  scenes?: KnownScene[];
  sessions?: SavedSession[];
}
