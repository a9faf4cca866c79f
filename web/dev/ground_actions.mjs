// Zones, beds and inflows of the stand-in: they are kept and told, and do nothing to its debris.
const outside = (key, value, low, high, unit) =>
  value === undefined || value === null || (typeof value === "number" && value >= low && value <= high) ? null : `${key} is ${value}; allowed is ${low} to ${high} ${unit}`.trim();
const ringArea = (ring) => Math.abs(ring.reduce((sum, [x, y], i) => {
  const [u, v] = ring[(i + 1) % ring.length];
  return sum + (x - ring[0][0]) * (v - ring[0][1]) - (u - ring[0][0]) * (y - ring[0][1]);
}, 0)) / 2;
const areaOf = (polygons) => polygons.reduce((sum, [outer, ...holes]) => sum + ringArea(outer) - holes.reduce((all, hole) => all + ringArea(hole), 0), 0);

const ranges = {
  zone: [["friction_coefficient", 1e-6, 9.999999, ""], ["turbulent_friction_mps2", 1e-6, 1e9, "m/s2"], ["cohesion_Pa", 0, 1e12, "Pa"], ["stem_density_pm2", 0, 1e6, "1/m2"],
    ["stem_diameter_m", 1e-6, 100, "m"], ["stem_drag_coefficient", 0, 1e6, ""]],
  bed: [["depth_m", 1e-6, 100, "m"], ["growth_rate_per_m", 1e-12, 1, "1/m"], ["critical_shear_stress_Pa", 0, 1e12, "Pa"], ["erosion_rate_mps", 1e-12, 10, "m/s"],
    ["erosion_depth_mpPa", 1e-12, 1, "m/Pa"]],
  inflow: [["direction_deg", 0, 359.999999, "deg"]],
};
const fresh = {
  zone: { friction_coefficient: null, turbulent_friction_mps2: null, cohesion_Pa: null, stem_density_pm2: 0, stem_diameter_m: 0.3, stem_drag_coefficient: 1, polygons: [], from_scene: false },
  bed: { depth_m: null, law: "growth", growth_rate_per_m: null, critical_shear_stress_Pa: 1000, erosion_rate_mps: 0.025, erosion_depth_mpPa: 1e-4, polygons: [], from_scene: false },
  inflow: { line: null, polygons: [], direction_deg: null, hydrograph: null, from_scene: false },
};
const measure = {
  zone: (zone) => ({ ...zone, area_m2: areaOf(zone.polygons) }),
  bed: (bed) => ({ ...bed, area_m2: areaOf(bed.polygons), volume_m3: areaOf(bed.polygons) * (bed.depth_m ?? 0) }),
  inflow: (inflow) => ({ ...inflow, volume_m3: inflow.hydrograph.slice(1).reduce((sum, row, k) =>
    sum + (row.time_s - inflow.hydrograph[k].time_s) * (row.discharge_m3ps + inflow.hydrograph[k].discharge_m3ps) / 2, 0) }),
};

function problem(kind, item) {
  for (const [key, low, high, unit] of ranges[kind]) {
    const error = outside(key, item[key], low, high, unit);
    if (error) return error;
  }
  if (kind === "bed" && item.law === "growth" && item.growth_rate_per_m === null) return "growth_rate_per_m is missing; law growth needs it";
  if (kind === "zone" && item.friction_coefficient === null && item.turbulent_friction_mps2 === null && item.cohesion_Pa === null && !(item.stem_density_pm2 > 0)) {
    return "the zone differs in nothing; give friction_coefficient, turbulent_friction_mps2, cohesion_Pa or stem_density_pm2";
  }
  if (kind !== "inflow") return null;
  const rows = item.hydrograph ?? [];
  if (rows.length < 2) return `hydrograph has ${rows.length} rows; it must have at least 2`;
  const late = rows.slice(1).find((row, k) => row.time_s <= rows[k].time_s);
  if (late) return `time_s is ${late.time_s}; it must be above that of the row before`;
  const still = rows.find((row) => item.line && row.discharge_m3ps > 0 && !(row.velocity_mps > 0));
  return still ? `velocity_mps is ${still.velocity_mps}; it must be above 0 where there is discharge` : null;
}

/** Of an action put_zone, put_bed or put_inflow: what the setup then holds; with a sentence as `error` where it is refused. */
export function groundItem(kind, old, { polygon, line, move_m, ...given }) {
  const item = { ...fresh[kind], ...old, ...given };
  if (polygon) Object.assign(item, { polygons: [[polygon]] }, kind === "inflow" ? { line: null } : {});
  if (line) Object.assign(item, { line, polygons: [] });
  if (move_m) {
    const moved = ([x, y]) => [x + move_m[0], y + move_m[1]];
    item.polygons = item.polygons.map((rings) => rings.map((ring) => ring.map(moved)));
    item.line &&= item.line.map(moved);
  }
  if (kind === "inflow") item.hydrograph = item.hydrograph?.map((row) => ({ density_kgpm3: null, ...row })) ?? null;
  const error = problem(kind, item);
  return error ? { error } : measure[kind](item);
}

const same = (a, b) => JSON.stringify({ ...a, name: "" }) === JSON.stringify({ ...b, name: "" });
/** Beds and inflows as they are told: whether they are those that the run began with. */
export function told(setup, begun) {
  const list = (kind) => setup[kind].map((item) => ({ ...item, in_force: begun[kind].some((other) => same(item, other)) }));
  const [beds, inflows] = [list("beds"), list("inflows")];
  return { beds, inflows, pending_restart: [...beds, ...inflows].some((item) => !item.in_force) || beds.length !== begun.beds.length || inflows.length !== begun.inflows.length };
}
