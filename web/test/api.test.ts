import { afterEach, expect, test, vi } from "vitest";
import { Api, Refused } from "../src/protocol/api";
import { Server } from "../src/protocol/server";

afterEach(() => vi.unstubAllGlobals());

/** A body of which the connection breaks after the first bytes. */
const broken = (): Response => new Response(new ReadableStream({
  start(controller) {
    controller.enqueue(new TextEncoder().encode('{"scenarios": ['));
    controller.error(new TypeError("Failed to fetch"));
  },
}));

test.each([
  ["before the answer", () => Promise.reject(new TypeError("Failed to fetch"))],
  ["inside the answer", () => Promise.resolve(broken())],
])("a connection that breaks %s is a server that does not answer", async (_, answer) => {
  vi.stubGlobal("fetch", answer);
  const api = new Api(new Server("token"));
  for (const asked of [api.session(), api.exported("A", "report.html"), api.act("A", { action: "restart" } as never)]) {
    await expect(asked).rejects.toThrow(new Refused(0, "The server does not answer."));
    await expect(asked).rejects.toBeInstanceOf(Refused);
  }
  expect(api.reads.ended).toBe(api.reads.begun);
});

test("an answer that is no JSON keeps the error of the reader", async () => {
  vi.stubGlobal("fetch", () => Promise.resolve(new Response("<html>")));
  await expect(new Api(new Server("token")).session()).rejects.toBeInstanceOf(SyntaxError);
});
