// The transport to talus serve: fetch and a WebSocket beside the page's own address.
import type { Possible, Transport, Wire, WireEvents } from "./transport";

export class Server implements Transport {
  readonly can: Possible = { change: true, server: true };

  constructor(private readonly token: string) {}

  private headers(type: string | null, secret: string | null): Record<string, string> {
    return { Authorization: `Bearer ${this.token}`, ...(type === null ? {} : { "Content-Type": type }), ...(secret === null ? {} : { "Talus-Person": secret }) };
  }
  ask(method: string, path: string, body: object | undefined, secret: string | null): Promise<Response> {
    const headers = this.headers(body === undefined ? null : "application/json", secret);
    return fetch(`api/${path}`, { method, headers, ...(body === undefined ? {} : { body: JSON.stringify(body) }) });
  }
  /** fetch does not tell how much of a body has been sent. */
  upload(path: string, file: File, secret: string | null, onshare: (share: number) => void): Promise<Response> {
    return new Promise((resolve, reject) => {
      const request = new XMLHttpRequest();
      request.open("PUT", `api/${path}`);
      for (const [name, value] of Object.entries(this.headers("application/octet-stream", secret))) request.setRequestHeader(name, value);
      request.upload.addEventListener("progress", (event) => onshare(event.loaded / Math.max(1, file.size)));
      request.addEventListener("error", () => reject(new TypeError("the connection broke")));
      request.addEventListener("load", () => resolve(new Response(request.responseText, { status: request.status })));
      request.send(file);
    });
  }
  connect(name: string, secret: string | null, events: WireEvents): Wire {
    const base = new URL("ws", location.href);
    base.protocol = base.protocol === "https:" ? "wss:" : "ws:";
    base.hash = "";
    base.search = new URLSearchParams({ token: this.token, name, ...(secret ? { person: secret } : {}) }).toString();
    const socket = new WebSocket(base);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => events.opened();
    socket.onmessage = (event: MessageEvent<unknown>) => {
      if (typeof event.data === "string" || event.data instanceof ArrayBuffer) events.message(event.data);
    };
    socket.onclose = () => events.closed();
    return {
      send: (text) => {
        if (socket.readyState === WebSocket.OPEN) socket.send(text);
      },
      close: () => socket.close(),
    };
  }
}
