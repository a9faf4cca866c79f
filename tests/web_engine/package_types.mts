// What a program in TypeScript sees of talus-engine: compiled by tests/web_engine/run.sh, with the types of the package checked as well.
import { earthMatrix, openTwin, toEarth, type Change, type Grid, type Impacts, type Particles, type State } from "talus-engine";

export async function use(packed: Uint8Array): Promise<number> {
  const twin = await openTwin(packed, { thread: "caller" });
  const change: Change = { action: "put_barrier", line: [[0, 0], [10, 0]], height_m: 3, thickness_m: 1 };
  const made: string | null = (await twin.run.act(change)).created;
  // @ts-expect-error a run is moved by step() and advance() alone
  await twin.run.act({ action: "run" });
  // @ts-expect-error there is no such map
  await twin.run.map("nonsense");
  const state: State = await twin.run.advance(1);
  const particles: Particles = await twin.run.particles(state.time_s);
  const depth: Grid = await twin.run.map("peak_depth");
  const impacts: Impacts = await twin.run.impacts();
  const earth: Float64Array = toEarth(earthMatrix(twin.scene, () => [114, 22]), particles.positions);
  return earth.length + depth.values.length + impacts.barriers.filter((one) => one.id === made).length;
}
