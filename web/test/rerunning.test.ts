import { describe, expect, it } from "vitest";
import { rerunning } from "../src/state/rerunning";

describe("work that is asked for while it runs", () => {
  it("is done once more, however often it was asked for, and all wait for that", async () => {
    let value = 1;
    const seen: number[] = [];
    const waiting: (() => void)[] = [];
    const refresh = rerunning(async () => {
      const now = value;
      await new Promise<void>((resolve) => waiting.push(resolve));
      seen.push(now);
    });
    const first = refresh();
    value = 2;
    const others = [refresh(), refresh()];
    waiting.shift()?.();
    await Promise.resolve();
    await Promise.resolve();
    waiting.shift()?.();
    await Promise.all([first, ...others]);
    expect(seen).toEqual([1, 2]);
    const later = refresh();
    waiting.shift()?.();
    await later;
    expect(seen).toEqual([1, 2, 2]);
  });
  it("can be asked for again after it has failed", async () => {
    let fails = true;
    const refresh = rerunning(async () => {
      if (fails) throw new Error("no");
    });
    await expect(refresh()).rejects.toThrow("no");
    fails = false;
    await refresh();
  });
});
