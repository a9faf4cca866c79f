import { describe, expect, it } from "vitest";
import { encodeFrame, encodeGrid } from "../dev/wire.mjs";
import { absent, decodeFrame, MalformedMessage } from "../src/protocol/frame";
import { decodeGrid, gridAt } from "../src/protocol/grid";

// A Buffer of Node may be a part of a larger pool: the copy is not.
const buffer = (bytes: Uint8Array): ArrayBuffer => Uint8Array.from(bytes).buffer;

function content() {
  return {
    scenario: 1, flags: 5, time: 12.625, step: 4_294_967_299, slots: 5, stride: 2, origin: [-10, 5, 100], scale: [0.01, 0.02, 0.005], speedScale: 0.1,
    window: [3, 7, 2, 2], depthScale: 0.001, mapSpeedScale: 0.2, x: Uint16Array.of(0, 65534, absent), y: Uint16Array.of(40000, 3, absent),
    z: Uint16Array.of(1, 2, absent), speed: Uint8Array.of(0, 255, 7), depth: Uint16Array.of(0, 65535, 12, 3), mapSpeed: Uint8Array.of(9, 0, 1, 255),
  };
}

describe("frame", () => {
  it("gives back what was sent, also at the ends of the number range", async () => {
    const frame = await decodeFrame(buffer(encodeFrame(content())));
    expect(frame.scenario).toBe("B");
    expect(frame.flags).toBe(5);
    expect(frame.time_s).toBe(12.625);
    expect(frame.step).toBe(4_294_967_299);
    expect(frame.count).toBe(3);
    expect([...frame.particles]).toEqual([0, 40000, 1, 0, 65534, 3, 2, 255, absent, absent, absent, 7]);
    expect(frame.window).toEqual({ column: 3, row: 7, columns: 2, rows: 2 });
    expect([...frame.depth]).toEqual([0, 65535, 12, 3]);
    expect([...frame.mapSpeed]).toEqual([9, 0, 1, 255]);
    expect(frame.origin).toEqual([-10, 5, 100]);
    expect(frame.scale[1]).toBeCloseTo(0.02, 7);
    expect(frame.mapSpeedUnit_mps).toBeCloseTo(0.2, 7);
  });
  it("takes a frame without particles and without depth", async () => {
    const none = new Uint16Array();
    const frame = await decodeFrame(buffer(encodeFrame({ ...content(), slots: 0, stride: 1, window: [0, 0, 0, 0], x: none, y: none, z: none,
      speed: new Uint8Array(), depth: none, mapSpeed: new Uint8Array() })));
    expect(frame.count).toBe(0);
    expect(frame.depth.length).toBe(0);
  });
  it.each([
    ["another tag", (b: Uint8Array) => b.fill(65, 0, 4)],
    ["another version", (b: Uint8Array) => b.fill(2, 4, 5)],
    ["a stride of 0", (b: Uint8Array) => b.fill(0, 28, 32)],
    ["a body of another size", (b: Uint8Array) => b.fill(1, 84, 85)],
  ])("refuses %s", async (_, spoil) => {
    const bytes = Uint8Array.from(encodeFrame(content()));
    spoil(bytes);
    await expect(decodeFrame(buffer(bytes))).rejects.toThrow(MalformedMessage);
  });
  it("refuses a frame that is cut off", async () => {
    const bytes = Uint8Array.from(encodeFrame(content()));
    await expect(decodeFrame(buffer(bytes.slice(0, 40)))).rejects.toThrow(MalformedMessage);
    await expect(decodeFrame(buffer(bytes.slice(0, bytes.length - 6)))).rejects.toThrow();
  });
});

describe("grid", () => {
  const values = Float32Array.of(1, 2, 3, 4, NaN, 6);
  it("gives back what was sent", async () => {
    const grid = await decodeGrid(buffer(encodeGrid(824090, 825520, 2, 3, 2, values)));
    expect(grid).toMatchObject({ west: 824090, south: 825520, cell: 2, columns: 3, rows: 2 });
    expect([...grid.values]).toEqual([1, 2, 3, 4, NaN, 6]);
  });
  it("is read between cell centres, with rows from the south", async () => {
    const grid = await decodeGrid(buffer(encodeGrid(0, 0, 2, 3, 2, values)));
    expect(gridAt(grid, 1, 1)).toBe(1);
    expect(gridAt(grid, 2, 1)).toBeCloseTo(1.5);
    expect(gridAt(grid, 1, 3)).toBe(4);
    expect(gridAt(grid, 3, 3)).toBeNaN();
    expect(gridAt(grid, 4, 3)).toBe(6);
    expect(gridAt(grid, 7, 1)).toBeNaN();
  });
});
