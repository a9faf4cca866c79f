// The package talus-engine, with an engine of the test in place of the built one.
import { readFileSync } from "node:fs";
import { MessageChannel } from "node:worker_threads";
import { afterEach, describe, expect, it } from "vitest";
import { answerCalls, Here, There, type Answer, type Call, type Computer, type Port } from "../engine_package/src/computer";
import { earthMatrix, toEarth } from "../engine_package/src/earth";
import { Twin } from "../engine_package/src/twin";
import type { Engine, EngineAnswer } from "../src/engine/engine";
import { Refused } from "../src/protocol/api";

/** A run of steps of 0.25 s that is over after 20 of them. */
class Fake implements Engine {
  onSend = (): void => undefined;
  steps = 0;
  broken = false;
  readonly asked: string[] = [];
  open = (packed: Uint8Array): { hash: string } => {
    if (packed[0] !== 1) throw new Error("the packed scene is cut short");
    return { hash: "0f" };
  };
  join = (): number => 1;
  leave = (): void => undefined;
  message = (): void => undefined;
  tick = (): number => -1;
  request(method: string, path: string, body: Uint8Array | string): EngineAnswer {
    if (this.broken) throw new Error("the page has no memory left for this");
    this.asked.push(`${method} ${path} ${String(body)}`.trim());
    const answer = (status: number, content: object): EngineAnswer => ({ status, type: "application/json", body: new TextEncoder().encode(JSON.stringify(content)) });
    const over = this.steps === 20;
    if (path === "/api/scene") return answer(200, { title: "Test", orthophoto: false });
    if (path === "/api/scenarios/A/state") return answer(200, { time_s: 0.25 * this.steps, step: this.steps, status: over ? "ended" : "paused" });
    if (path.startsWith("/api/scenarios/A/frame")) return { status: 200, type: "application/octet-stream", body: new Uint8Array(readFileSync(new URL("recorded/frame.bin", import.meta.url))) };
    if (path === "/api/scenarios" && method === "POST") return answer(200, { done: "scenario B", created: "B" });
    if (path !== "/api/scenarios/A/actions") return answer(404, { error: `there is no ${path}` });
    const { action } = JSON.parse(String(body)) as { action: string };
    if (action === "step" && over) return answer(400, { error: "step: nothing is left to compute (End reached); restart it" });
    if (action === "step") ++this.steps;
    if (action === "restart") this.steps = 0;
    return action === "put_barrier" ? answer(400, { error: "height_m = -1; allowed are 0.01 to 100" }) : answer(200, { done: action, created: null });
  }
}

const ports: { close(): void }[] = [];
afterEach(() => ports.splice(0).forEach((port) => port.close()));
/** As in a worker. */
function there(engine: Engine): Computer {
  const { port1, port2 } = new MessageChannel();
  ports.push(port1, port2);
  answerCalls(port2 as unknown as Port<Answer>, new Here(() => Promise.resolve(engine)));
  return new There(port1 as unknown as Port<Call>, () => port2.close());
}
const here = (engine: Engine): Computer => new Here(() => Promise.resolve(engine));
const open = (computer: Computer, scene = [1]): Promise<Twin> => Twin.open(computer, Uint8Array.from(scene), new ArrayBuffer(8));

describe.each([["in the caller's thread", here], ["in a worker", there]])("a twin %s", (_, computer) => {
  it("advances by a time, and no step further", async () => {
    const fake = new Fake();
    const { run } = await open(computer(fake));
    expect((await run.advance(3)).step).toBe(12);
    expect((await run.advance(0.1)).step).toBe(13);
    expect((await run.step(2)).step).toBe(15);
  });
  it("ends where the run is over", async () => {
    const { run } = await open(computer(new Fake()));
    expect(await run.advance(1000)).toMatchObject({ status: "ended", step: 20 });
    expect(await run.step(3)).toMatchObject({ status: "ended", step: 20 });
    await run.act({ action: "restart" });
    expect(await run.step(25)).toMatchObject({ status: "ended", step: 20 });
  });
  it("answers while it advances", async () => {
    const fake = new Fake();
    const { run } = await open(computer(fake));
    const states = await Promise.all([run.advance(5), run.state(), run.act({ action: "undo" })]);
    expect(states[0].step).toBe(20);
    expect(fake.asked.some((one) => one.includes("undo"))).toBe(true);
  });
  it("refuses in the engine's sentence, and what is not for a run that is stepped", async () => {
    const { run } = await open(computer(new Fake()));
    await expect(run.act({ action: "put_barrier", height_m: -1 })).rejects.toThrow("height_m = -1; allowed are 0.01 to 100");
    await expect(run.act({ action: "run" } as never)).rejects.toThrow(/action = "run".*advance/);
    await expect(run.advance(-1)).rejects.toThrow("duration_s = -1; it is a number from 0 to 10000000");
    await expect(run.advance(NaN)).rejects.toBeInstanceOf(Refused);
    await expect(run.step(0)).rejects.toThrow("count = 0");
    await expect(open(computer(new Fake()), [2])).rejects.toThrow("cut short");
  });
  it("is of no use after a failure, and says why each time", async () => {
    const fake = new Fake();
    const { run } = await open(computer(fake));
    fake.broken = true;
    await expect(run.advance(1)).rejects.toThrow("no memory left");
    fake.broken = false;
    await expect(run.state()).rejects.toThrow("no memory left");
  });
  it("refuses what is asked after it was closed", async () => {
    const twin = await open(computer(new Fake()));
    twin.close();
    await expect(twin.run.state()).rejects.toThrow("closed");
  });
  it("gives particles as typed arrays, without those that are gone", async () => {
    const { run } = await open(computer(new Fake()));
    const { count, positions, speeds, ids } = await run.particles();
    expect(count).toBeGreaterThan(0);
    expect([positions.length, speeds.length, ids.length]).toEqual([3 * count, count, count]);
    expect(positions.every(Number.isFinite)).toBe(true);
    expect(ids.every((id, k) => k === 0 || id > ids[k - 1]!)).toBe(true);
  });
  it("copies a run under the name that it gets", async () => {
    const { run } = await open(computer(new Fake()));
    expect((await run.copy({ action: "undo" })).name).toBe("B");
  });
});

describe("a twin on the globe", () => {
  // The Hong Kong 1980 Grid near Sham Tseng: what the program's transformation gives, on a straight line between two of its places.
  const toDegrees = (east: number, north: number): [number, number] => [114.060331121317 + (east - 824265) * 9.7062e-6, 22.3706156604093 + (north - 825720) * 9.0307e-6];
  const scene = { crs: "EPSG:2326", origin: [824265, 825720, 100] as [number, number, number], extent_m: [824065, 825520, 824465, 825920] as [number, number, number, number] };

  it("has its origin where the ellipsoid has it, with axes to the east, north and up", () => {
    const m = earthMatrix(scene, toDegrees, -2);
    // Of gdaltransform, EPSG:4979 to EPSG:4978.
    expect([m[12], m[13], m[14]].map((v) => Math.round(10 * v!) / 10)).toEqual([-2405860.4, 5388374, 2412451.2]);
    const length = (k: number): number => Math.hypot(m[k]!, m[k + 1]!, m[k + 2]!);
    expect(length(0)).toBeCloseTo(1, 2);
    expect(length(4)).toBeCloseTo(1, 2);
    expect(length(8)).toBeCloseTo(1, 12);
    expect(m[8]! * m[12]! + m[9]! * m[13]! + m[10]! * m[14]!).toBeGreaterThan(6.3e6);
  });
  it("puts positions there to the millimetre", () => {
    const m = earthMatrix(scene, toDegrees);
    const [x, y, z] = toEarth(m, Float32Array.of(0, 0, 0, 0, 0, 10)).subarray(3);
    expect(Math.hypot(x! - m[12]!, y! - m[13]!, z! - m[14]!)).toBeCloseTo(10, 6);
  });
  it("is not where nobody knows", () => {
    expect(() => earthMatrix(scene, () => [NaN, NaN])).toThrow("EPSG:2326: its place on the globe is not known");
  });
});
