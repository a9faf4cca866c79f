// A tape as src/publish/tape.cpp writes it (tests/publish/tape_test.cpp), made here by hand.
import { readFileSync } from "node:fs";
import { deflateSync } from "node:zlib";
import { describe, expect, it } from "vitest";
import { Api, Refused } from "../src/protocol/api";
import { between } from "../src/protocol/between";
import { absent, decodeFrame, MalformedMessage, type Frame } from "../src/protocol/frame";
import { Recorded } from "../src/protocol/recorded";
import { Tape } from "../src/protocol/tape";

const frame = Uint8Array.from(readFileSync(new URL("recorded/frame.bin", import.meta.url)));
const text = (content: object): Buffer => Buffer.from(JSON.stringify(content));

interface Entry { address: string; time_s?: number; body: Uint8Array }
function tapeOf(entries: readonly Entry[], messages: object[] = [], version = 1): Uint8Array {
  const answers: Record<string, object> = {};
  const times: Record<string, object[]> = {};
  const bodies: Buffer[] = [];
  let at = 0;
  for (const { address, time_s, body } of entries) {
    const deflated = body[0] !== 0x54;
    const kept = deflated ? deflateSync(body) : Buffer.from(body);
    const place = { type: deflated ? "application/json" : "application/octet-stream", at, size: kept.length, ...(deflated ? { whole: body.length } : {}) };
    if (time_s === undefined) answers[address] = place;
    else (times[address] ??= []).push({ ...place, time_s });
    bodies.push(kept);
    at += kept.length;
  }
  const whole = text({ messages, answers, times });
  const packed = deflateSync(whole);
  const start = Buffer.alloc(16);
  start.write("TLST");
  [version, packed.length, whole.length].forEach((value, k) => start.writeUInt32LE(value, 4 + 4 * k));
  return Uint8Array.from(Buffer.concat([start, packed, ...bodies]));
}
const some = (): Entry[] => [
  { address: "scenarios/A/impacts", body: text({ buildings: ["at the end"] }) },
  ...[0, 2, 5].map((time_s) => ({ address: "scenarios/A/impacts", time_s, body: text({ buildings: [`at ${time_s}`] }) })),
  ...[0, 1].map((time_s) => ({ address: "scenarios/A/frame", time_s, body: frame })),
];
const api = async (entries = some()): Promise<Api> => new Api(new Recorded(await Tape.open(tapeOf(entries))));

describe("a recording", () => {
  it.each([[null, "at the end"], [0, "at 0"], [1.99, "at 0"], [2, "at 2"], [4, "at 2"], [99, "at 5"]])("has at %s s what was last known then", async (time, wanted) => {
    expect(await (await api()).impacts("A", time)).toEqual({ buildings: [wanted] });
  });
  it("refuses changes, and what it does not hold, in sentences", async () => {
    const recorded = await api();
    await expect(recorded.act("A", { action: "run" } as never)).rejects.toThrow(new Refused(409, "This is a recording: it can be watched, not changed."));
    await expect(recorded.addOverlay(new File([], "a.kml"), () => undefined)).rejects.toThrow("it can be watched");
    await expect(recorded.orthophoto()).rejects.toThrow(new Refused(404, "The recording does not hold this."));
  });
  it("says its messages in order, and shows the last frame of what is looked at", async () => {
    const tape = await Tape.open(tapeOf(some(), [{ type: "hello" }, { type: "state" }]));
    const heard: unknown[] = [];
    await new Promise<void>((done) => {
      const wire = new Recorded(tape).connect("", null, { opened: () => void heard.push("open"), closed: () => undefined, message: (data) => {
        heard.push(typeof data === "string" ? (JSON.parse(data) as { type: string }).type : data.byteLength);
        if (data === '{"type":"state"}') wire.send('{"type":"view","scenarios":["A"]}');
        if (typeof data !== "string") done();
      } });
    });
    expect(heard).toEqual(["open", "hello", "state", frame.length]);
  });
  it("reads at a point what its frames have there", async () => {
    const { window: w, depth, depthUnit_m, mapSpeed, mapSpeedUnit_mps } = await decodeFrame(frame.buffer);
    const deepest = depth.indexOf(Math.max(...depth));
    const map = { x_min_m: 100, y_min_m: 200, cell_m: 2 };
    const recorded = await api([...some(), { address: "scene", body: text({ map }) }]);
    const at = (cell: number): [number, number] => [map.x_min_m + 2 * (w.column + (cell % w.columns)) + 1, map.y_min_m + 2 * (w.row + Math.floor(cell / w.columns)) + 1];
    const series = await recorded.probe("A", ...at(deepest));
    expect(series.time_s).toEqual([0, 1]);
    expect(series.depth_m[0]).toBeCloseTo(depth[deepest] * depthUnit_m, 6);
    expect(series.depth_m[0]).toBeGreaterThan(0.3);
    expect(series.speed_mps[1]).toBeCloseTo(mapSpeed[deepest] * mapSpeedUnit_mps, 6);
    expect((await recorded.probe("A", map.x_min_m - 50, map.y_min_m)).depth_m).toEqual([0, 0]);
  });
});

describe("a frame between two of a recording", () => {
  const moved = async (metres: number, time_s: number): Promise<Frame> => {
    const one = await decodeFrame(frame.buffer.slice(0));
    return { ...one, time_s, origin: [one.origin[0] + metres, one.origin[1], one.origin[2]] };
  };
  const xOf = (f: Frame, i: number): number => f.origin[0] + f.particles[4 * i] * f.scale[0];
  it("has each particle on its straight way, and those that are not there nowhere", async () => {
    const [from, to] = [await moved(0, 10), await moved(8, 12)];
    const quarter = between(from, to, 10.5);
    expect(quarter.time_s).toBe(10.5);
    expect(quarter.count).toBe(from.count);
    for (let i = 0; i < from.count; ++i) {
      if (from.particles[4 * i] === absent) expect(quarter.particles[4 * i]).toBe(absent);
      else {
        expect(xOf(quarter, i) - xOf(from, i)).toBeCloseTo(2, 1);
        expect(Math.abs(quarter.particles[4 * i + 3] - from.particles[4 * i + 3])).toBeLessThanOrEqual(1);
      }
    }
  });
  it("is the recorded one at its time, and the last one after the end", async () => {
    const [from, to] = [await moved(0, 10), await moved(8, 12)];
    expect(between(from, to, 10)).toBe(from);
    expect(xOf(between(from, to, 99), 0)).toBeCloseTo(xOf(to, 0), 1);
    expect(between(from, from, 11)).toBe(from);
  });
  it("is what a page that plays a recording gets", async () => {
    const recorded = await api();
    expect((await recorded.frame("A", 0.5)).time_s).toBe((await decodeFrame(frame.buffer.slice(0))).time_s);  // both are the same one here
    expect((await recorded.frame("A", 7)).count).toBeGreaterThan(0);
  });
});

describe("a damaged recording", () => {
  const whole = tapeOf(some());
  it.each([
    ["nothing", new Uint8Array(), "no recording"],
    ["something else", Uint8Array.from({ length: 100 }, () => 65), "no recording"],
    ["another version", tapeOf([], [], 2), "version 2"],
    ["a part of its head", whole.slice(0, 40), "cut off"],
  ])("is refused in a sentence: %s", async (_, bytes, sentence) => {
    await expect(Tape.open(bytes)).rejects.toThrow(sentence);
    await expect(Tape.open(bytes)).rejects.toBeInstanceOf(MalformedMessage);
  });
  it("that lacks its end says so when it is asked for", async () => {
    await expect(new Recorded(await Tape.open(whole.slice(0, -10))).ask("GET", "scenarios/A/frame?time_s=1")).rejects.toThrow("cut off");
  });
});
