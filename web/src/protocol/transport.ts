// How the page reaches what it shows: a server over the network, the engine in a worker, or a recording in the file itself.

import type { Frame } from "./frame";

/** What can be done where the page is; the rest is not offered. */
export interface Possible {
  /** Runs, and changes of them. */
  change: boolean;
  /** What needs a computer that serves: other people, jobs, uploads, saved sessions, files of the moving flow. */
  server: boolean;
}

export interface WireEvents {
  opened(): void;
  /** A message of docs/protocol.md as text, or a frame. */
  message(data: string | ArrayBuffer): void;
  closed(): void;
}

/** The WebSocket half of docs/protocol.md, however it travels. */
export interface Wire {
  /** Nothing while it is not open. */
  send(text: string): void;
  close(): void;
}

export interface Transport {
  readonly can: Possible;
  /** `path`: below /api/. `secret`: of this page's person. Rejects with a TypeError where nothing answers, as fetch does. */
  ask(method: string, path: string, body: object | undefined, secret: string | null): Promise<Response>;
  /** Sends a file; `onshare` is told which share of it has been sent. */
  upload(path: string, file: File, secret: string | null, onshare: (share: number) => void): Promise<Response>;
  /** A frame of the recording of a scenario, where it need not be asked for as a message. */
  frame?(scenario: string, time_s: number): Promise<Frame | null>;
  /** `secret`: of a person who was here before a break. */
  connect(name: string, secret: string | null, events: WireEvents): Wire;
}
