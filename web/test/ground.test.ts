import { describe, expect, it } from "vitest";
import type { Bed, Inflow, Point, Setup, Zone } from "../src/protocol/messages";
import { Relief } from "../src/scene/relief";
import { fields } from "../src/protocol/schema";
import { shownAs, toldAs } from "../src/state/format";
import { bedNote, lawChange, zoneNote } from "../src/state/ground";
import { arrowAlong, arrowsOf, downhill_deg, hasDensity, inflowNote, peakOf, rowsAndOne, rowsOfDensity, rowsWith, rowsWithout, rowsForServer, usualHydrograph, volumeOf } from "../src/state/inflows";
import { groundUnder } from "../src/state/picking";
import { canReshape, fewestPoints, hasOutline, itemOf, mostPoints, pointsOf, type Item } from "../src/state/shapes";

const square = (west: number, south: number, side: number): Point[] => [[west, south], [west + side, south], [west + side, south + side], [west, south + side]];
const zone = (id: string, polygons: Point[][][]): Zone => ({ id, name: id, polygons, area_m2: 0, friction_coefficient: 0.4, turbulent_friction_mps2: null, laminar_viscosity_m2ps: null, cohesion_Pa: null,
  stem_density_pm2: 0, stem_diameter_m: 0.3, stem_drag_coefficient: 1, from_scene: false });
const bed = (id: string, polygons: Point[][][]): Bed => ({ id, name: id, polygons, depths_m: polygons.map(() => 1.5), area_m2: 0, volume_m3: 120, depth_m: 1.5, law: "growth", growth_rate_per_m: 0.01,
  critical_shear_stress_Pa: 1000, erosion_rate_mps: 0.025, erosion_depth_mpPa: 1e-4, from_scene: false, in_force: true });
const inflow = (id: string, line: Point[] | null, polygons: Point[][][] = []): Inflow => ({ id, name: id, line, polygons, direction_deg: null, hydrograph: [...usualHydrograph], volume_m3: 200,
  from_scene: false, in_force: true });

describe("zones and beds", () => {
  it("are told in the server's units, without digits that say nothing", () => {
    const { stem_density_pm2, cohesion_Pa } = fields.zone;
    expect(toldAs(stem_density_pm2, 300)).toBe(0.03);
    expect(shownAs(stem_density_pm2, 0.07)).toBe(700);
    expect(toldAs(cohesion_Pa, 0.3)).toBe(300);
    expect(shownAs(cohesion_Pa, toldAs(cohesion_Pa, 1.1))).toBe(1.1);
  });
  it("say in a list what is different", () => {
    const plain = zone("a", []);
    expect(zoneNote(plain)).toBe("friction 0.4");
    expect(zoneNote({ ...plain, stem_density_pm2: 0.04 })).toBe("forest 400/ha, friction 0.4");
    expect(zoneNote({ ...plain, stem_density_pm2: 0.04, cohesion_Pa: 1500 })).toBe("forest 400/ha, …");
    expect(zoneNote({ ...plain, friction_coefficient: null })).toBe("as elsewhere");
    expect(bedNote(bed("b", []))).toBe("1.5\u202fm, 120\u202fm³");
    expect(bedNote({ ...bed("b", []), depth_m: null })).toBe("120\u202fm³");
    expect(bedNote({ ...bed("b", []), in_force: false })).toBe("120\u202fm³, next restart");
  });
  it("a law brings what it needs", () => {
    expect(lawChange(bed("b", []), "shear")).toEqual({ law: "shear" });
    expect(lawChange({ growth_rate_per_m: 0.02 }, "growth")).toEqual({ law: "growth", growth_rate_per_m: 0.02 });
    expect(lawChange({ growth_rate_per_m: null }, "growth")).toEqual({ law: "growth", growth_rate_per_m: 0.005 });
  });
});

describe("hydrographs", () => {
  const rows = [...usualHydrograph];
  it("have a volume and a peak", () => {
    expect(volumeOf(rows)).toBe(200);
    expect(peakOf(rows)).toBe(10);
    expect(inflowNote(inflow("i", null))).toBe("200\u202fm³, 10\u202fm³/s");
    expect(inflowNote({ ...inflow("i", null), hydrograph: null })).toBe("200\u202fm³");
  });
  it("change a number, stay in the order of time, and refuse what is none", () => {
    expect(rowsWith(rows, 1, "discharge_m3ps", 20)?.[1].discharge_m3ps).toBe(20);
    expect(rowsWith(rows, 3, "time_s", 12)?.map((r) => r.time_s)).toEqual([0, 5, 12, 20]);
    expect(rowsWith(rows, 1, "time_s", NaN)).toBeNull();
    expect(rowsWith(rows, 1, "velocity_mps", -1)).toBeNull();
    expect(rows).toEqual([...usualHydrograph]);
  });
  it("gain and lose rows", () => {
    expect(rowsAndOne(rows).at(-1)).toEqual({ time_s: 30, discharge_m3ps: 0, velocity_mps: 5 });
    expect(rowsWithout(rows, 0)).toEqual(rows.slice(1));
  });
  it("have a density in all rows or in none, and none is left out", () => {
    const dense = rowsOfDensity(rows, 1900);
    expect(hasDensity(rows)).toBe(false);
    expect(hasDensity(dense)).toBe(true);
    expect(rowsForServer(dense)[2]).toEqual({ time_s: 20, discharge_m3ps: 10, velocity_mps: 5, density_kgpm3: 1900 });
    expect(rowsForServer(rowsOfDensity(dense, null))).toEqual(rows);
  });
});

describe("the way of an inflow", () => {
  it("is to the right of its line, seen from the first end", () => {
    const arrows = arrowsOf([[0, 0], [0, 30]]);
    expect(arrows).toHaveLength(2);
    for (const [from, tip] of arrows) {
      expect(from[0]).toBe(0);
      expect(tip[0]).toBeGreaterThan(3);
      expect(tip[1]).toBeCloseTo(from[1]);
    }
    expect(arrowsOf([[0, 30], [0, 0]])[0][1][0]).toBeLessThan(-3);
    expect(arrowsOf([[5, 5], [5, 5]])).toEqual([]);
  });
  it("is clockwise from north over an area", () => {
    const [from, tip] = arrowAlong([100, 200], 90, 400);
    expect(tip[0] - from[0]).toBeCloseTo(8);
    expect(tip[1]).toBeCloseTo(200);
  });
  it("begins downhill", () => {
    const values = new Float32Array(400);
    for (let k = 0; k < 400; ++k) values[k] = 2 * (k % 20);
    expect(downhill_deg(new Relief({ west: 0, south: 0, cell: 1, columns: 20, rows: 20, values }, [0, 0, 0]), [10, 10])).toBe(270);
  });
});

describe("outlines", () => {
  const setup = { releases: [], barriers: [], buildings: [], zones: [zone("z", [[[...square(0, 0, 10), [0, 0]]]])], beds: [bed("b", [])],
    inflows: [inflow("i", [[0, 0], [5, 0]])] } as unknown as Setup;
  const item = (shape: Item["shape"], id: string): Item => itemOf(setup, { shape, id }) as Item;
  it("are a ring without its repeated corner, a line, or not there", () => {
    expect(pointsOf(item("zone", "z"))).toEqual(square(0, 0, 10));
    expect(pointsOf(item("inflow", "i"))).toEqual([[0, 0], [5, 0]]);
    expect(pointsOf(item("bed", "b"))).toEqual([]);
    expect([hasOutline(item("zone", "z")), hasOutline(item("inflow", "i")), hasOutline(item("bed", "b"))]).toEqual([true, true, false]);
    expect(canReshape(item("bed", "b"))).toBe(false);
    expect(itemOf(setup, { shape: "zone", id: "i" })).toBeNull();
  });
  it("an inflow's line has two points, its area three or more", () => {
    expect([fewestPoints("inflow", true), mostPoints("inflow", true)]).toEqual([2, 2]);
    expect([fewestPoints("inflow", false), mostPoints("inflow", false)]).toEqual([3, Infinity]);
    expect([fewestPoints("barrier", false), mostPoints("barrier", false)]).toEqual([2, Infinity]);
  });
});

describe("a click on the ground", () => {
  const setup = { zones: [zone("wide", [[square(0, 0, 100)]]), zone("middle", [[square(0, 0, 40), square(10, 10, 10)]])], beds: [bed("small", [[square(5, 25, 10)]])],
    inflows: [inflow("across", [[30, 30], [38, 30]]), inflow("over", null, [[square(20, 0, 20)]])] } as unknown as Setup;
  const under = (x: number, y: number): string | undefined => groundUnder(setup, [x, y], 1, 10_000)?.id;
  it("means the nearest line, else the smallest area", () => {
    expect(under(34, 30.8)).toBe("across");
    expect(under(34, 32)).toBe("middle");
    expect(under(7, 30)).toBe("small");
    expect(under(30, 10)).toBe("over");
    expect(under(2, 2)).toBe("middle");
  });
  it("means nothing in a hole, and no area that covers much of the terrain", () => {
    expect(under(15, 15)).toBeUndefined();
    expect(under(90, 90)).toBeUndefined();
    expect(groundUnder(setup, [90, 90], 1, 100_000)?.id).toBe("wide");
  });
});
