// Messages that the real program sent (tests/browser/record_messages.mjs), and such with a byte changed.
import { readFileSync } from "node:fs";
import { deflateSync } from "node:zlib";
import { describe, expect, it } from "vitest";
import { absent, decodeFrame, MalformedMessage, recycle } from "../src/protocol/frame";
import { decodeGrid, gridAt } from "../src/protocol/grid";

// A Buffer of Node may be a part of a larger pool: the copy is not.
const recorded = (name: string): Uint8Array<ArrayBuffer> => Uint8Array.from(readFileSync(new URL(`recorded/${name}`, import.meta.url)));
const moment = JSON.parse(readFileSync(new URL("recorded/moment.json", import.meta.url), "utf8")) as {
  time_s: number; step: number; particles: number; particle_spacing_m: number; origin: [number, number, number];
  extent_m: [number, number, number, number]; elevation_m: [number, number]; map: { cell_m: number; columns: number; rows: number };
};
/** The recorded frame with its head changed. */
function frameWith(change: (head: DataView) => void): ArrayBuffer {
  const { buffer } = recorded("frame.bin");
  change(new DataView(buffer));
  return buffer;
}

describe("frame", () => {
  it("says when it is, and has every particle on the ground or in the bed", async () => {
    const frame = await decodeFrame(recorded("frame.bin").buffer);
    const ground = await decodeGrid(recorded("terrain.bin").buffer);
    expect(frame).toMatchObject({ scenario: "A", flags: 0, stride: 1, time_s: moment.time_s, step: moment.step });
    let there = 0;
    const largest = [0, 0, 0];
    for (let i = 0; i < frame.count; ++i) {
      const stored = [...frame.particles.subarray(4 * i, 4 * i + 3)];
      if (stored.includes(absent)) {
        expect(stored).toEqual([absent, absent, absent]);
        continue;
      }
      ++there;
      stored.forEach((v, axis) => (largest[axis] = Math.max(largest[axis], v)));
      const [x, y, z] = stored.map((v, axis) => moment.origin[axis] + frame.origin[axis] + v * frame.scale[axis]);
      const height = z - gridAt(ground, x, y);
      expect(height, `particle ${i}`).toBeGreaterThan(-2.1); // the depth of the bed
      expect(height, `particle ${i}`).toBeLessThan(4);
    }
    expect(there).toBe(moment.particles);
    expect(frame.count).toBeGreaterThan(there);
    expect(largest).toEqual([65534, 65534, 65534]);
  });
  it("holds depths that add up to the debris", async () => {
    const { window, depth, depthUnit_m, mapSpeed } = await decodeFrame(recorded("frame.bin").buffer);
    expect(window.column + window.columns).toBeLessThanOrEqual(moment.map.columns);
    expect(window.row + window.rows).toBeLessThanOrEqual(moment.map.rows);
    expect([depth.length, mapSpeed.length]).toEqual([window.columns * window.rows, window.columns * window.rows]);
    const volume = depth.reduce((sum, v) => sum + v * depthUnit_m, 0) * moment.map.cell_m ** 2;
    expect(volume / (moment.particles * moment.particle_spacing_m ** 3)).toBeCloseTo(1, 2);
  });
  it("lies in what a frame that was given back has left, and in nothing that is in use", async () => {
    const whole = await decodeFrame(recorded("frame.bin").buffer);
    const [first, second] = [await decodeFrame(recorded("frame.bin").buffer, true), await decodeFrame(recorded("frame.bin").buffer, true)];
    expect(second.particles.buffer).not.toBe(first.particles.buffer);
    const left = [first.particles.buffer, first.depth.buffer, first.mapSpeed.buffer];
    recycle(first);
    recycle(first);
    recycle(whole);
    const [third, fourth] = [await decodeFrame(recorded("frame.bin").buffer, true), await decodeFrame(recorded("frame.bin").buffer, true)];
    expect([third.particles.buffer, third.depth.buffer, third.mapSpeed.buffer]).toEqual(left);
    expect(third.particles.buffer).toBe(left[0]);
    expect(fourth.particles.buffer).not.toBe(left[0]);
    for (const frame of [second, third, fourth]) {
      const { room, ...rest } = frame;
      expect(room).toBeDefined();
      expect(rest).toEqual(whole);
    }
  });
  it("knows scenario B, flags and large step numbers", async () => {
    const frame = await decodeFrame(frameWith((head) => {
      head.setUint8(5, 1);
      head.setUint16(6, 5, true);
      head.setBigUint64(16, 4_294_967_299n, true);
    }));
    expect(frame).toMatchObject({ scenario: "B", flags: 5, step: 4_294_967_299 });
  });
  it("takes a frame without particles and without depth", async () => {
    const head = frameWith((view) => [24, 68, 72, 84].forEach((at) => view.setUint32(at, 0, true))).slice(0, 88);
    const frame = await decodeFrame(await new Blob([head, Uint8Array.from(deflateSync(""))]).arrayBuffer());
    expect([frame.count, frame.depth.length]).toEqual([0, 0]);
  });
  it.each([
    ["another tag", (head: DataView) => head.setUint8(0, 65)],
    ["another version", (head: DataView) => head.setUint8(4, 2)],
    ["a stride of 0", (head: DataView) => head.setUint32(28, 0, true)],
    ["a body of another size", (head: DataView) => head.setUint8(84, head.getUint8(84) ^ 1)],
  ])("refuses %s", async (_, spoil) => {
    await expect(decodeFrame(frameWith(spoil))).rejects.toThrow(MalformedMessage);
  });
  it("refuses a frame that is cut off", async () => {
    const { buffer } = recorded("frame.bin");
    await expect(decodeFrame(buffer.slice(0, 40))).rejects.toThrow(MalformedMessage);
    await expect(decodeFrame(buffer.slice(0, buffer.byteLength - 6))).rejects.toThrow();
  });
});

describe("grid", () => {
  it("gives back the terrain that the server has", async () => {
    const grid = await decodeGrid(recorded("terrain.bin").buffer);
    const [west, south, east, north] = moment.extent_m;
    expect(grid).toMatchObject({ west, south, cell: 1, columns: east - west, rows: north - south });
    expect(Math.min(...grid.values)).toBe(moment.elevation_m[0]);
    expect(Math.max(...grid.values)).toBe(moment.elevation_m[1]);
    // The gully of tests/browser/twin/gully.mjs: 0.577 m deeper per metre to the east, its bank 0.5 m higher per metre.
    expect(gridAt(grid, west + 10, south + 25) - gridAt(grid, west + 11, south + 25)).toBeCloseTo(0.577, 3);
    expect(gridAt(grid, west + 80, south + 5) - gridAt(grid, west + 80, south + 6)).toBeCloseTo(0.5, 3);
  });
  it("reads every coding to the bit", async () => {
    const [columns, rows] = [5, 3];
    const values = Float32Array.from({ length: columns * rows }, (_, i) => (i === 7 ? NaN : 100 + 0.37 * i * i));
    values[3] = -0;
    const bits = new Int32Array(values.buffer);
    // The laws of docs/protocol.md, written once more.
    const folded = bits.map((bit, i) => {
      const [west, south] = [i % columns > 0, i >= columns];
      const d = (bit - ((west ? bits[i - 1]! : 0) + (south ? bits[i - columns]! : 0) - (west && south ? bits[i - columns - 1]! : 0))) | 0;
      return (d << 1) ^ (d >> 31);
    });
    const planes = (numbers: Int32Array): Uint8Array => Uint8Array.from([0, 8, 16, 24].flatMap((shift) => [...numbers].map((n) => (n >>> shift) & 255)));
    const message = (coding: number, body: Uint8Array): ArrayBuffer => {
      const packed = deflateSync(body);
      const bytes = new Uint8Array(44 + packed.length);
      bytes.set(new TextEncoder().encode("TLSG"));
      bytes.set([2, coding], 4);
      const head = new DataView(bytes.buffer);
      [columns, rows, body.length].forEach((n, i) => head.setUint32(32 + 4 * i, n, true));
      bytes.set(packed, 44);
      return bytes.buffer;
    };
    for (const [coding, body] of [[0, new Uint8Array(values.buffer)], [1, planes(folded)], [2, planes(bits)]] as const) {
      const grid = await decodeGrid(message(coding, body));
      expect([...new Int32Array(grid.values.buffer, grid.values.byteOffset, grid.values.length)], `coding ${coding}`).toEqual([...bits]);
    }
    await expect(decodeGrid(message(3, planes(bits)))).rejects.toThrow(MalformedMessage);
  });
  it("is read between cell centres, with rows from the south", () => {
    const grid = { west: 0, south: 0, cell: 2, columns: 3, rows: 2, values: Float32Array.of(1, 2, 3, 4, NaN, 6) };
    expect(gridAt(grid, 1, 1)).toBe(1);
    expect(gridAt(grid, 2, 1)).toBeCloseTo(1.5);
    expect(gridAt(grid, 1, 3)).toBe(4);
    expect(gridAt(grid, 3, 3)).toBeNaN();
    expect(gridAt(grid, 4, 3)).toBe(6);
    expect(gridAt(grid, 7, 1)).toBeNaN();
  });
});
