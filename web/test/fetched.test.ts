import { describe, expect, it } from "vitest";
import { Fetched } from "../src/state/fetched";

interface Entry { id: string }
const [a, b]: Entry[] = [{ id: "a" }, { id: "b" }];

/** As layers of the page do: each arrival looks at all entries again. */
function fetched(): { list: Fetched<Entry, string>; asked: string[]; dropped: string[]; arrivals(): number; answer(content: string | null): Promise<void> } {
  const asked: string[] = [];
  const dropped: string[] = [];
  const waiting: ((content: string | null) => void)[] = [];
  let arrivals = 0;
  const list = new Fetched<Entry, string>(({ id }) => {
    asked.push(id);
    return new Promise((resolve) => waiting.push(resolve));
  }, () => {
    ++arrivals;
    for (const entry of [a, b]) list.of(entry);
  }, (content) => dropped.push(content));
  return { list, asked, dropped, arrivals: () => arrivals, answer: async (content) => {
    waiting.shift()?.(content);
    await Promise.resolve();
  } };
}

describe("contents of a list", () => {
  it("are asked for once, and are there when they have come", async () => {
    const { list, asked, arrivals, answer } = fetched();
    expect(list.of(a)).toBeNull();
    expect(list.of(a)).toBeNull();
    expect(asked).toEqual(["a"]);
    await answer("A");
    expect(list.of(a)).toBe("A");
    expect(list.held("a")).toBe("A");
    expect(arrivals()).toBe(1);
  });
  it("are not asked for again after a failure until the list has changed", async () => {
    const { list, asked, arrivals, answer } = fetched();
    list.of(a);
    await answer(null);
    expect(arrivals()).toBe(0);
    expect([list.of(a), list.of(a)]).toEqual([null, null]);
    expect(asked).toEqual(["a"]);
    list.keep([a, b]);
    list.of(a);
    expect(asked).toEqual(["a", "a"]);
    await answer("A");
    expect(list.of(a)).toBe("A");
  });
  it("are dropped with their entry, whether they had come or not", async () => {
    const { list, asked, dropped, answer } = fetched();
    list.of(a);
    await answer("A");  // asks for b too
    list.keep([b]);
    expect(dropped).toEqual(["A"]);
    expect(list.held("a")).toBeNull();
    list.keep([]);
    await answer("B");
    expect(dropped).toEqual(["A", "B"]);
    expect(list.held("b")).toBeNull();
    expect(asked).toEqual(["a", "b"]);
  });
});
