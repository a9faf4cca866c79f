// Generated from the field table by `talus scene reference --typescript`; a test keeps it current.

/** A body of debris that starts to move at one moment; a scene needs one, or an inflow. */
export interface ReleaseValues {
  /** Uniform thickness. null: one of the other three is given. */
  thickness_m: number | null;
}

/** Inflow of debris during the run, any number of them: across a straight line, at right angles to it and towards its right, or all over an area, such as a slope that rain wears down. */
export interface InflowValues {
  /** Over an area: direction in which the debris flows in, clockwise from north. null: down the slope. */
  direction_deg: number | null;
}

/** A row of an inflow's hydrograph, a CSV of its own in a scene; linear between rows. */
export interface HydrographValues {
  /** Simulated time; above that of the row before. */
  time_s: number;
  /** Bulk volume of debris that flows in per second. */
  discharge_m3ps: number;
  /** Along the ground; above 0 where debris flows in across a line. */
  velocity_mps: number;
  /** Bulk density of the inflow; in every row or in none. null: the material's rest density. */
  density_kgpm3: number | null;
}

/** Loose material on the ground that debris entrains where it moves over it. */
export interface BedValues {
  /** Uniform depth of the bed, vertical; debris entrains no more. null: one of the other two is given. */
  depth_m: number | null;
  /** How debris picks it up: growth adds a share of its volume per metre that it moves (McDougall & Hungr 2005); shear goes by the shear stress on the bed (Frank et al. 2015). */
  law: "growth" | "shear";
  /** Share of its volume that debris entrains per metre: ln(volume after / volume before) over the length of the bed. null: law = "growth" needs it, and law = "shear" does not have it. */
  growth_rate_per_m: number | null;
  /** With law = "shear": less shear stress, rest density x gravity x depth x sine of the slope, entrains nothing. */
  critical_shear_stress_Pa: number;
  /** With law = "shear": how fast the bed is lowered. */
  erosion_rate_mps: number;
  /** With law = "shear": how deep at most, per shear stress above the critical one. */
  erosion_depth_mpPa: number;
}

/** Solid obstacles with vertical walls and flat roofs. */
export interface BuildingsValues {
  /** Height above the ground where the attribute is absent, empty or not above zero; counted as assumed. */
  height_m: number;
}

/** A wall, a dam or a net along a line; any number. */
export interface BarrierValues {
  /** Height above the ground under the line: the crest follows the ground. null: crest_elevation_m is given. */
  height_m: number | null;
  /** Elevation of a level crest. null: height_m is given. */
  crest_elevation_m: number | null;
  /** Thickness across the line; at least half a particle spacing. */
  thickness_m: number;
  /** Makes it a net: the share of the debris, by volume, in grains that pass its meshes (the percentage passing at the size of the opening, over 100). The others are held as by a wall. null: it is a wall. */
  passing_share: number | null;
  /** Height above the ground of the gap below it, as nets hang across a torrent: debris passes freely there; at least one particle spacing, or nothing gets through. null: it reaches the ground. */
  clearance_m: number | null;
  /** Filtered force per metre of the line above which it is destroyed: it is gone from then on. null: it never fails. */
  resistance_Npm: number | null;
  /** Impact pressure (outputs.impact_patch_edge_m) above which it is destroyed. null: it never fails. */
  resistance_Pa: number | null;
}

/** A slot or a spillway in a barrier, as check dams have; any number. */
export interface BarrierOpeningValues {
  /** Distance of its middle along the barrier's line from its first place. */
  position_m: number;
  /** Width along the line; at least two particle spacings, or nothing gets through. */
  width_m: number;
  /** How much of the barrier stands there, above the ground; 0: open to the ground. */
  sill_height_m: number;
}

/** Debris properties. */
export interface MaterialValues {
  /** Coulomb friction on the ground (tangent of the friction angle), and on buildings and inside unless set apart. */
  friction_coefficient: number;
  /** Coulomb friction on the walls and roofs of buildings. null: equal to friction_coefficient. */
  building_friction_coefficient: number | null;
  /** Coulomb friction of debris on debris. null: equal to friction_coefficient, with samosat twice that. */
  internal_friction_coefficient: number | null;
  /** Share of the velocity difference to its neighbours that debris loses per 1/60 s, at any time step. The same share is another material at another particle spacing; kinematic_viscosity_m2ps is not. */
  viscosity: number;
  /** Voellmy's xi: flow of thickness h is slowed by g v2 / (xi h) in addition to Coulomb friction. null: none. */
  turbulent_friction_mps2: number | null;
  /** Laminar drag: flow of thickness h is slowed by 3 nu v / h2 over its whole depth, beside Coulomb and turbulent friction. nu is the kinematic viscosity, dynamic viscosity over density: the viscous term of FLO-2D and HEC-RAS with K = 24. null: none. */
  laminar_viscosity_m2ps: number | null;
  /** Shear strength at zero normal stress, on the ground and inside: the yield stress of a mud without friction. */
  cohesion_Pa: number;
  /** r_u, pore pressure over the total normal stress when debris starts: friction on ground, buildings and inside is 1 - r_u of what it is in dry debris. */
  pore_pressure_ratio: number;
  /** Bulk density of the debris. */
  rest_density_kgpm3: number;
}

/** Ground with its own resistance. A cell of the terrain belongs to it if its centre does. Values that a zone does not set are those of [material]; later zones override earlier ones. */
export interface ZoneValues {
  /** Coulomb friction on this ground. null: as in [material]. */
  friction_coefficient: number | null;
  /** Voellmy's xi on this ground; lower is rougher. null: as in [material]. */
  turbulent_friction_mps2: number | null;
  /** Kinematic viscosity of laminar drag on this ground. null: as in [material]. */
  laminar_viscosity_m2ps: number | null;
  /** Shear strength at zero normal stress between debris and this ground. null: as in [material]. */
  cohesion_Pa: number | null;
  /** Stems of a forest per square metre that stand the flow; each drags on it as a cylinder. */
  stem_density_pm2: number;
  /** Diameter of a stem. */
  stem_diameter_m: number;
  /** Drag coefficient of a stem across the flow. */
  stem_drag_coefficient: number;
}

/** How a form shows a value: times `factor`, in this unit. `first`: what it begins with; `tick`: the label of the box that gives it and takes it away. */
export interface FieldDescription {
  label: string; unit: string; factor: number; low: number; high: number; sliderLow: number; sliderHigh: number; first: number;
  tick: string | null; tickHelp: string; help: string;
}

/** By section and key. */
export const fields = {
  release: {
    thickness_m: {
      label: "Thickness", unit: "m", factor: 1, low: 0.001, high: 1000, sliderLow: 0.1, sliderHigh: 10, first: 1.5,
      tick: null, tickHelp: "", help: "Uniform thickness.",
    },
  },
  inflow: {
    direction_deg: {
      label: "Clockwise from north", unit: "deg", factor: 1, low: 0, high: 359.99, sliderLow: 0, sliderHigh: 359, first: 0,
      tick: "Set direction", tickHelp: "Direction in which debris flows in; unticked: downhill", help: "Over an area: direction in which the debris flows in, clockwise from north.",
    },
  },
  hydrograph: {
    time_s: {
      label: "Time", unit: "s", factor: 1, low: 0, high: 10000000, sliderLow: 0, sliderHigh: 60, first: 0,
      tick: null, tickHelp: "", help: "Simulated time; above that of the row before.",
    },
    discharge_m3ps: {
      label: "Discharge", unit: "m3/s", factor: 1, low: 0, high: 10000000, sliderLow: 0, sliderHigh: 50, first: 0,
      tick: null, tickHelp: "", help: "Bulk volume of debris that flows in per second.",
    },
    velocity_mps: {
      label: "Velocity", unit: "m/s", factor: 1, low: 0, high: 300, sliderLow: 0, sliderHigh: 20, first: 0,
      tick: null, tickHelp: "", help: "Along the ground; above 0 where debris flows in across a line.",
    },
    density_kgpm3: {
      label: "Density", unit: "kg/m3", factor: 1, low: 1, high: 30000, sliderLow: 1000, sliderHigh: 2500, first: 2000,
      tick: null, tickHelp: "", help: "Bulk density of the inflow; in every row or in none.",
    },
  },
  bed: {
    depth_m: {
      label: "Depth", unit: "m", factor: 1, low: 0.0001, high: 100, sliderLow: 0.1, sliderHigh: 5.1, first: 1,
      tick: null, tickHelp: "", help: "Uniform depth of the bed, vertical; debris entrains no more.",
    },
    growth_rate_per_m: {
      label: "Growth rate", unit: "1/m", factor: 1, low: 1e-06, high: 1, sliderLow: 0.0005, sliderHigh: 0.0505, first: 0.005,
      tick: null, tickHelp: "", help: "Share of its volume that debris entrains per metre: ln(volume after / volume before) over the length of the bed.",
    },
    critical_shear_stress_Pa: {
      label: "Critical shear stress", unit: "kPa", factor: 0.001, low: 0, high: 10000, sliderLow: 0, sliderHigh: 5, first: 1,
      tick: null, tickHelp: "", help: "With law = \"shear\": less shear stress, rest density x gravity x depth x sine of the slope, entrains nothing.",
    },
    erosion_rate_mps: {
      label: "Erosion rate", unit: "m/s", factor: 1, low: 1e-05, high: 10, sliderLow: 0.001, sliderHigh: 0.101, first: 0.013,
      tick: null, tickHelp: "", help: "With law = \"shear\": how fast the bed is lowered.",
    },
    erosion_depth_mpPa: {
      label: "Erosion depth", unit: "m/kPa", factor: 1000, low: 0.0001, high: 1000, sliderLow: 0.01, sliderHigh: 1.01, first: 0.05,
      tick: null, tickHelp: "", help: "With law = \"shear\": how deep at most, per shear stress above the critical one.",
    },
  },
  buildings: {
    height_m: {
      label: "Height", unit: "m", factor: 1, low: 0.001, high: 1000, sliderLow: 0.5, sliderHigh: 40, first: 6,
      tick: null, tickHelp: "", help: "Height above the ground where the attribute is absent, empty or not above zero; counted as assumed.",
    },
  },
  barrier: {
    height_m: {
      label: "Height", unit: "m", factor: 1, low: 0.001, high: 200, sliderLow: 0.5, sliderHigh: 15, first: 3,
      tick: null, tickHelp: "", help: "Height above the ground under the line: the crest follows the ground.",
    },
    thickness_m: {
      label: "Thickness", unit: "m", factor: 1, low: 0.0001, high: 100, sliderLow: 0.1, sliderHigh: 5, first: 1,
      tick: null, tickHelp: "", help: "Thickness across the line; at least half a particle spacing.",
    },
    passing_share: {
      label: "Passes the meshes", unit: "%", factor: 100, low: 0, high: 99.999, sliderLow: 0, sliderHigh: 95, first: 50,
      tick: "Net", tickHelp: "Lets the finer share of the debris through its meshes and holds the rest", help: "Makes it a net: the share of the debris, by volume, in grains that pass its meshes (the percentage passing at the size of the opening, over 100). The others are held as by a wall.",
    },
    clearance_m: {
      label: "Clearance", unit: "m", factor: 1, low: 0.0001, high: 100, sliderLow: 0.1, sliderHigh: 3, first: 0.5,
      tick: "Gap below", tickHelp: "It hangs above the ground: debris passes below it", help: "Height above the ground of the gap below it, as nets hang across a torrent: debris passes freely there; at least one particle spacing, or nothing gets through.",
    },
    resistance_Npm: {
      label: "Resistance", unit: "kN/m", factor: 0.001, low: 0.001, high: 1e+09, sliderLow: 10, sliderHigh: 1000, first: 200,
      tick: "Fails under load", tickHelp: "Beyond this mean force on its line it is gone", help: "Filtered force per metre of the line above which it is destroyed: it is gone from then on.",
    },
  },
  zone: {
    friction_coefficient: {
      label: "Coefficient", unit: "", factor: 1, low: 0, high: 10, sliderLow: 0.05, sliderHigh: 1.05, first: 0.4,
      tick: "Friction", tickHelp: "A separate Coulomb friction; unticked: as in [material]", help: "Coulomb friction on this ground.",
    },
    turbulent_friction_mps2: {
      label: "Voellmy's ξ", unit: "m/s2", factor: 1, low: 1, high: 1000000, sliderLow: 100, sliderHigh: 2100, first: 500,
      tick: "Turbulent friction", tickHelp: "A separate Voellmy turbulent friction; unticked: as in [material]", help: "Voellmy's xi on this ground; lower is rougher.",
    },
    laminar_viscosity_m2ps: {
      label: "Viscosity", unit: "m2/s", factor: 1, low: 0, high: 1000000, sliderLow: 0, sliderHigh: 0.2, first: 0.04,
      tick: "Laminar drag", tickHelp: "A separate viscosity of laminar drag; unticked: as in [material]", help: "Kinematic viscosity of laminar drag on this ground.",
    },
    cohesion_Pa: {
      label: "Shear strength", unit: "kPa", factor: 0.001, low: 0, high: 10000, sliderLow: 0, sliderHigh: 10, first: 1,
      tick: "Cohesion", tickHelp: "A separate cohesion; unticked: as in [material]", help: "Shear strength at zero normal stress between debris and this ground.",
    },
    stem_density_pm2: {
      label: "Stems", unit: "1/ha", factor: 10000, low: 0, high: 10000000, sliderLow: 50, sliderHigh: 1550, first: 400,
      tick: "Forest", tickHelp: "Stems that drag on the flow", help: "Stems of a forest per square metre that stand the flow; each drags on it as a cylinder.",
    },
    stem_diameter_m: {
      label: "Stem diameter", unit: "m", factor: 1, low: 0.001, high: 100, sliderLow: 0.05, sliderHigh: 1.05, first: 0.3,
      tick: null, tickHelp: "", help: "Diameter of a stem.",
    },
    stem_drag_coefficient: {
      label: "Drag coefficient", unit: "", factor: 1, low: 0, high: 100, sliderLow: 0, sliderHigh: 3, first: 1,
      tick: null, tickHelp: "", help: "Drag coefficient of a stem across the flow.",
    },
  },
} as const satisfies Record<string, Record<string, FieldDescription>>;

/** What ties a value to others. `spacings`: it is at least so many particle spacings; `below`: the key that it is below, where that is given; `needs`: a key of the scene without which the value is refused. */
export interface Tie {
  spacings?: number; why?: string;
  below?: string;
  needs?: { key: string; value: string; why: string };
}

/** By section and key. */
export const ties: Record<string, Record<string, Tie>> = {
  barrier: {
    thickness_m: {
      spacings: 0.5, why: "thinner walls let debris interact across them",
    },
    clearance_m: {
      spacings: 1, why: "nothing passes through lower gaps; smaller particles allow less",
      below: "height_m",
    },
  },
  barrier_opening: {
    width_m: {
      spacings: 2, why: "nothing passes through narrower ones; smaller particles allow less",
    },
  },
  material: {
    cohesion_Pa: {
      needs: { key: "solver.internal_friction", value: "stress", why: "friction by pairs has no such law" },
    },
    pore_pressure_ratio: {
      needs: { key: "solver.internal_friction", value: "stress", why: "friction by pairs has no such law" },
    },
  },
  zone: {
    cohesion_Pa: {
      needs: { key: "solver.internal_friction", value: "stress", why: "friction by pairs has no such law" },
    },
  },
};
