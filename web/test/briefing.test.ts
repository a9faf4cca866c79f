import { describe, expect, it } from "vitest";
import type { Impacts, Series } from "../src/protocol/messages";
import { course, endOfFlow, frontAt, hitUntil } from "../src/state/briefing";
import { webm } from "../src/state/webm";

const series = { time: {}, front: { chainage_m: [0, 10, 20, 30], arrival_time_s: [0, 2, 4, null], front_velocity_mps: [5, 5, 4, null], particle_speed_mps: [] } } as unknown as Series;

describe("the course of a briefing", () => {
  it("shows the run at the chosen speed between two views that stand", () => {
    const moments = course(0, 8, 4);
    expect(moments.length).toBe(25 * (2 + 2 + 3));
    expect(moments[0]).toEqual({ film_s: 0, run_s: 0, part: "before" });
    expect(moments[75].run_s).toBeCloseTo(4, 6);
    expect(moments[75].part).toBe("flow");
    expect(moments.at(-1)).toMatchObject({ run_s: 8, part: "after" });
  });
  it("is only the flow without the whole scene", () => {
    const moments = course(0, 8, 4, false);
    expect(moments.length).toBe(50);
    expect(moments.every((m) => m.part === "flow")).toBe(true);
  });
  it("ends soon after the front does", () => {
    expect(endOfFlow(series, 90)).toBe(7);
    expect(endOfFlow(series, 5)).toBe(5);
    expect(endOfFlow(null, 90)).toBe(90);
  });
  it("has the front between the places where it was timed", () => {
    expect(frontAt(series, 3)).toEqual({ chainage_m: 15, velocity_mps: 5 });
    expect(frontAt(series, 4.5)).toEqual({ chainage_m: 20, velocity_mps: 4 });
    expect(frontAt(series, 9)).toEqual({ chainage_m: 20, velocity_mps: 0 });
    expect(frontAt(null, 9)).toBeNull();
  });
  it("names what was hit, the latest first", () => {
    const impacts = { buildings: [{ name: "a", first_hit_s: 3 }, { name: "b", first_hit_s: null }], barriers: [{ name: "c", first_hit_s: 5 }, { name: "d", first_hit_s: 9 }], removed: [] } as unknown as Impacts;
    expect(hitUntil(impacts, 6).map((hit) => hit.name)).toEqual(["c", "a"]);
  });
});

describe("a WebM file", () => {
  it("holds every picture with its time, in clusters that begin often enough", async () => {
    const pictures = Array.from({ length: 300 }, (_, k) => ({ time_ms: 40 * k, key: k % 50 === 0, bytes: new Uint8Array([k & 0xff, 7]) }));
    const bytes = new Uint8Array(await webm(pictures, { width: 640, height: 360, codec: "V_VP8", lasts_ms: 12_000 }).arrayBuffer());
    /** Elements from `at` to `end`: ids and contents. */
    const read = (at: number, end: number): { id: number; from: number; to: number }[] => {
      const list = [];
      while (at < end) {
        const length = Math.clz32(bytes[at]) - 23;
        const id = bytes.subarray(at, at + length).reduce((sum, b) => 256 * sum + b, 0);
        const size = bytes.subarray(at + length + 1, at + length + 8).reduce((sum, b) => 256 * sum + b, 0);
        list.push({ id, from: at + length + 8, to: at + length + 8 + size });
        at += length + 8 + size;
      }
      expect(at).toBe(end);
      return list;
    };
    const [head, segment] = read(0, bytes.length);
    expect(head.id).toBe(0x1a45dfa3);
    expect(segment.id).toBe(0x18538067);
    const parts = read(segment.from, segment.to);
    const clusters = parts.filter((part) => part.id === 0x1f43b675);
    expect(clusters.length).toBeGreaterThan(1);
    const times = clusters.flatMap((cluster) => {
      const [begun, ...blocks] = read(cluster.from, cluster.to);
      const base = bytes.subarray(begun.from, begun.to).reduce((sum, b) => 256 * sum + b, 0);
      expect(bytes[blocks[0].from + 3]).toBe(0x80);
      return blocks.map((block) => base + 256 * bytes[block.from + 1] + bytes[block.from + 2]);
    });
    expect(times).toEqual(pictures.map((p) => p.time_ms));
  });
});
