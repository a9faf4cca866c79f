// What the stand-in server says about its scene, layers and impacts.
const parameter = (key, label, unit, value, low, high, help) => ({ key, label, unit, default: value, value, help,
  range: { low, high, low_included: true, high_included: true } });

export function describe(valley, particles, endTime) {
  const g = valley.ground;
  const parameters = [
    parameter("material.friction_coefficient", "Friction coefficient", "", 0.4, 0, 10,
      "Coulomb friction between debris and ground: shear stress over normal stress."),
    parameter("material.viscosity", "Viscosity", "", 0.1, 0, 100, "Share of the difference to neighbours' velocities taken away in a second."),
    parameter("material.rest_density_kgpm3", "Rest density", "kg/m3", 2000, 0, 30000, "Density of debris at rest."),
  ];
  let low = Infinity, high = -Infinity;
  for (const z of g.z) { low = Math.min(low, z); high = Math.max(high, z); }
  const origin = [g.xMin + 0.5 * g.columns * g.cell, g.yMin + 0.5 * g.rows * g.cell, Math.floor(low)];
  let along = 0;
  const chainage = valley.path.map(([x, y], k) => (along += k === 0 ? 0 : Math.hypot(x - valley.path[k - 1][0], y - valley.path[k - 1][1])));
  const path = { points: valley.path.map(([x, y]) => [x, y, g.at(x, y)]), chainage_m: chainage, corridor_width_m: 50, traced: false };
  const scene = {
    title: valley.title, description: "An invented flow on real ground: the stand-in server.", reconstruction: true,
    assumptions: ["The flow is invented."], sources: [], crs: valley.crs, crs_name: valley.crsName, vertical_unit: "m", origin,
    extent_m: [g.xMin, g.yMin, g.xMax, g.yMax], elevation_m: [low, high],
    map: { x_min_m: g.xMin, y_min_m: g.yMin, cell_m: g.cell, columns: g.columns, rows: g.rows },
    orthophoto: false, particle_spacing_m: 0.4, end_time_s: endTime, gravity_mps2: 9.81, flow_path: path, observations: valley.observations, parameters,
    intensity: {
      classes: [{ name: "low", colour: "#f3d34a", depth_m: 0 }, { name: "medium", colour: "#e5792b", depth_m: 0.5 },
        { name: "high", colour: "#8e1430", depth_m: 1 }],
      rule: "high: depth of 1 m and more with a speed of 1 m/s and more; low: depth below 0.5 m; medium: all else",
      source: "stand-in",
    },
  };
  return { scene, options: { parameters, particles, endTime, path, origin } };
}

export const gridLayers = (s) => ({ depth: s.debris.depth, peak_depth: s.debris.peakDepth, peak_speed: s.debris.peakSpeed,
  peak_pressure: s.debris.peakPressure, arrival_time: s.debris.arrival, deposit_depth: s.debris.deposit });

export function impacts(s) {
  const row = (o) => {
    const h = s.hits.get(o.id);
    return { id: o.id, name: o.name, hit: h !== undefined, first_hit_s: h?.first ?? null, peak_force_kN: h?.force ?? null,
      peak_pressure_kPa: h?.pressure ?? null, peak_depth_m: h?.depth ?? null, peak_dynamic_pressure_kPa: h?.pressure ?? null,
      impulse_kNs: 0, failed_s: null, intensity: h === undefined ? null : h.depth >= 1 ? "high" : h.depth >= 0.5 ? "medium" : "low" };
  };
  return { buildings: s.setup.buildings.map(row), barriers: s.setup.barriers.map((b) => ({ ...row(b), overtopped_m3: 0,
    first_overtopped_s: null, passed_m3: 0, peak_filling_height_m: 0, held_m3: s.hits.get(b.id)?.held ?? 0 })), removed: [] };
}

export function probe(s, x, y) {
  const times = s.series.time_s, c = s.debris.cellOf(x, y);
  const peak = s.debris.peakDepth[c] || 0, arrival = s.debris.arrival[c];
  const depth = times.map((t) => (t >= arrival ? peak * Math.exp(-0.2 * (t - arrival)) : 0));
  const speed = times.map((t) => (t >= arrival ? (s.debris.peakSpeed[c] || 0) * Math.exp(-0.4 * (t - arrival)) : 0));
  return { time_s: times, depth_m: depth, speed_mps: speed, pressure_kPa: speed.map((v) => 2 * v * v) };
}
