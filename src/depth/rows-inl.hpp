// What a stage of the depth-averaged step keeps of a segment, row by row, and the reconstruction of a row. Included
// once per instruction set.
#if defined(TALUS_DEPTH_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_DEPTH_ROWS_INL
#undef TALUS_DEPTH_ROWS_INL
#else
#define TALUS_DEPTH_ROWS_INL
#endif

#include <array>
#include <hwy/highway.h>
#include <type_traits>

#include "depth/flight.hpp"
#include "depth/formulas.hpp"
#include "depth/soil.hpp"
#include "depth/stages.hpp"
#include "simd/lane_pairs.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {

constexpr int register_lanes = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
static_assert(tile_edge % register_lanes == 0);
using Register = simd::Lanes<register_lanes>;
using Edge = simd::Lanes<4>;  ///< for the cell or face at an end of a strip, and three more that nobody needs
/// For updates, whose divisions and square roots follow one another: two registers at once, where each is half a strip.
/// Faces and cells gain nothing by it, nor do longer registers.
using ForUpdates = std::conditional_t<register_lanes == 8, simd::LanePair<8>, Register>;

/// Numbers of a row of a segment. Entry 0 is the cell west of it; an edge may extend beyond the cell east of it. Strips
/// begin at cache lines.
struct alignas(tile_edge * sizeof(float)) Numbers {
    std::array<float, (largest_segment + 2) * tile_edge> numbers;

    [[nodiscard]] HWY_INLINE const float* at(int j) const { return numbers.data() + (j + tile_edge - 1); }
    [[nodiscard]] HWY_INLINE float* at(int j) { return numbers.data() + (j + tile_edge - 1); }
};

template <class L>
HWY_INLINE L load(const Numbers& from, int j) {
    return L::load(from.at(j));
}
template <class L>
HWY_INLINE void store(const L& numbers, Numbers& to, int j) {
    numbers.store(to.at(j));
}

/// What the faces on one side of a row of cells see of them.
struct SideRow {
    Numbers depth, normal, across, limit;
    /// 1: the neighbour there is dry and stands above the surface, or is the stream of an inflow; 2: a structure.
    Numbers wall;
};
/// Along an axis.
struct AxisRow {
    SideRow before, after;
    Numbers rise, wave;
};
struct Row {
    AxisRow x, y;
    Numbers at_rest, bed_x, bed_y;
    Numbers bed, square, lift, spare;  ///< the last three: see FaceSide, Motion
    Numbers pore_pressure;             ///< if it is carried
    Numbers solid_fraction;            ///< if pore pressure evolves
    Numbers height, upward;            ///< of flight, and the vertical velocity, if debris flies
};
/// Fluxes of a row of faces, that of energy with what is spare, and what the ground's curvature presses at them.
struct Faces {
    Numbers mass, normal, across, pressure_before, pressure_after, press, energy;
    Numbers pore_pressure;   ///< that goes with the mass, if it is carried
    Numbers solid_fraction;  ///< the same, if pore pressure evolves
    Numbers height, upward;  ///< the same, if debris flies
};
struct Scratch {
    std::array<Row, 2> rows;  ///< of the row and the one before it
    std::array<Numbers, 3> speed;
    Faces x;
    std::array<Faces, 2> y;
    Numbers change;  ///< of the cells of a column: more than 0 if there was any
};

struct Fastest {
    Register largest = Register(0);
    Register unknown = Register(0);  ///< 0, or NaN if there was one

    HWY_INLINE void take(const Register& signal) {
        largest = larger(largest, signal);
        unknown = unknown + signal * Register(0);
    }
    HWY_INLINE void take(const simd::LanePair<register_lanes>& signal) {
        take(signal.a);
        take(signal.b);
    }
};

/// What goes with the mass and resists.
template <class L>
struct Water {
    L pore_pressure;   ///< if it is carried
    L solid_fraction;  ///< if pore pressure evolves
    L speed;           ///< m/s, along the ground; the same
};

/// Friction of soil whose pore pressure evolves: (1 - lambda) tan(phi + psi), see sim/physics/pore_pressure.hpp.
template <class L>
HWY_INLINE L friction_of_soil(const StageData& data, const L& friction, const L& depth, const L& stretch,
                              const Water<L>& water) {
    const L zero(0), one(1), m = water.solid_fraction;
    const L thickness = larger(depth / stretch, L(thinnest_soil));
    const L density = L(data.soil.fluid_density) + L(data.soil.grain_density - data.soil.fluid_density) * m;
    const L share = one - water.pore_pressure;
    const L stress = share * density * thickness * L(data.gravity) / stretch;
    const L psi = dilatancy_of(data.soil, m, stress, (water.speed + water.speed) / thickness);
    const L angle = (friction + psi) / larger(L(0.1F), one - friction * psi);
    return select(friction > zero, share * larger(zero, angle), zero);
}

template <class L>
HWY_INLINE Resistance<L> resistance_at(const StageData& data, std::ptrdiff_t i, const L& depth, const L& stretch,
                                       const Water<L>& water) {
    const auto known = [&](const float* raster, float elsewhere) HWY_ATTR {
        if (raster == nullptr) return L(elsewhere);
        const L here = L::load(raster + i);
        return select(here == here, here, L(elsewhere));
    };
    Resistance<L> r;
    const L effective_share = data.from.pore_pressure == nullptr
                                  ? L(data.effective_share)
                                  : L(1) - water.pore_pressure * L(data.pore_pressure_left);
    const L dry_friction = known(data.cover.friction, data.friction);
    r.friction = data.from.solid_fraction == nullptr ? dry_friction * effective_share
                                                     : friction_of_soil(data, dry_friction, depth, stretch, water);
    r.strength = known(data.cover.strength, data.strength);
    r.inverse_turbulence = known(data.cover.inverse_turbulence, data.inverse_turbulence);
    if (data.laws.turbulent_thickness > 0) {
        const L thickness = larger(depth, L(dry_depth)) / stretch;
        r.inverse_turbulence = r.inverse_turbulence * sim::turbulence_at(data.laws, thickness);
    }
    if (data.laws.have_wall_drag()) {
        const L thickness = larger(depth, L(dry_depth)) / stretch;
        r.inverse_turbulence = sim::wall_drag(data.laws, thickness) / L(data.gravity);
    }
    r.moving_friction = data.laws.moving_friction<L>();
    r.stem_drag = known(data.cover.stem_drag, 0);
    r.viscosity = known(data.cover.viscosity, data.viscosity);
    return r;
}

template <class L>
HWY_INLINE void keep(const Line<L>& line, const L& wall_before, const L& wall_after, const L& wave,
                     const L& limit_before, const L& limit_after, AxisRow& row, int j) {
    const Sides<L> sides = sides_of(line);
    store(sides.depth_before, row.before.depth, j);
    store(sides.depth_after, row.after.depth, j);
    store(sides.rise, row.rise, j);
    store(sides.normal_before, row.before.normal, j);
    store(sides.normal_after, row.after.normal, j);
    store(sides.across_before, row.before.across, j);
    store(sides.across_after, row.after.across, j);
    store(limit_before, row.before.limit, j);
    store(limit_after, row.after.limit, j);
    store(wave, row.wave, j);
    store(wall_beside(line.depth, line.before, line.bed_before) + wall_before, row.before.wall, j);
    store(wall_beside(line.depth, line.after, line.bed_after) + wall_after, row.after.wall, j);
}

/// Reconstructs the entries of a row from `begin` to before `end`; `i`: index of entry 0.
template <class L>
HWY_INLINE void reconstruct(const StageData& data, std::ptrdiff_t i, int begin, int end, Row& row, Numbers& speed) {
    const std::ptrdiff_t up = data.stride;
    const L zero(0), one(1), dry_limit(dry_depth), gravity(data.gravity), inverse_cell(data.inverse_cell);
    const L flow_scale(0.999999F / (data.inverse_cell * data.time_step));
    for (int j = begin; j < end; j += L::size) {
        const auto at = [&](const float* raster, std::ptrdiff_t offset)
                            HWY_ATTR { return L::load(raster + (i + j + offset)); };
        const float *h = data.from.depth, *u = data.from.u, *v = data.from.v;
        const L bed = at(data.bed, 0), depth = at(h, 0);
        const L bed_west = at(data.bed, -1) - bed, bed_east = at(data.bed, 1) - bed;
        const L bed_south = at(data.bed, -up) - bed, bed_north = at(data.bed, up) - bed;
        const L west = at(h, -1), east = at(h, 1), south = at(h, -up), north = at(h, up);
        const L own_u = at(u, 0), own_v = at(v, 0);
        const auto dry = depth <= dry_limit;
        Line<L> x{depth, west, east, bed_west, bed_east, own_u, at(u, -1), at(u, 1), own_v, at(v, -1), at(v, 1)};
        Line<L> y{depth,      south,     north, bed_south,  bed_north, own_v,
                  at(v, -up), at(v, up), own_u, at(u, -up), at(u, up)};
        L wall_west(0), wall_east(0), wall_south(0), wall_north(0);
        if (data.structure != nullptr) {
            const L here = at(data.structure, 0);
            const auto wall = [&](const L& normal, const L& beside, const L& bed_beside,
                                  std::ptrdiff_t offset) HWY_ATTR {
                return structure_beside(depth, normal, gravity, beside, bed_beside, here, at(data.structure, offset));
            };
            wall_west = wall(own_u, west, bed_west, -1);
            wall_east = wall(own_u, east, bed_east, 1);
            wall_south = wall(own_v, south, bed_south, -up);
            wall_north = wall(own_v, north, bed_north, up);
            replace_structures(x, wall_west, wall_east);
            replace_structures(y, wall_south, wall_north);
            wall_west = wall_west + wall_west;
            wall_east = wall_east + wall_east;
            wall_south = wall_south + wall_south;
            wall_north = wall_north + wall_north;
        }
        if (data.inflow.depth != nullptr) {
            const L from_x = at(data.inflow.from_x, 0), from_y = at(data.inflow.from_y, 0);
            const L from_west = inflow_beside(zero - from_x, depth, x.before);
            const L from_east = inflow_beside(from_x, depth, x.after);
            const L from_south = inflow_beside(zero - from_y, depth, y.before);
            const L from_north = inflow_beside(from_y, depth, y.after);
            continue_stream(x, from_west, from_east);
            continue_stream(y, from_south, from_north);
            wall_west = wall_west + from_west;
            wall_east = wall_east + from_east;
            wall_south = wall_south + from_south;
            wall_north = wall_north + from_north;
        }
        const L bed_x = (x.bed_after - x.bed_before) * (inverse_cell * L(0.5F));
        const L bed_y = (y.bed_after - y.bed_before) * (inverse_cell * L(0.5F));
        const L square_stretch = one + bed_x * bed_x + bed_y * bed_y, stretch = sqrt(square_stretch);
        const L flatness = one / square_stretch;

        const L twice_wave = L(2) * sqrt(gravity * depth);
        const L out_west = larger(zero, twice_wave - own_u), out_east = larger(zero, twice_wave + own_u);
        const L out_south = larger(zero, twice_wave - own_v), out_north = larger(zero, twice_wave + own_v);
        const L can_flow =
            select(dry, zero, depth * flow_scale / (out_west + out_east + out_south + out_north + L(1e-12F)));
        keep(x, wall_west, wall_east, gravity * flatness * (one - flatness * bed_x * bed_x), can_flow * out_west,
             can_flow * out_east, row.x, j);
        keep(y, wall_south, wall_north, gravity * flatness * (one - flatness * bed_y * bed_y), can_flow * out_south,
             can_flow * out_north, row.y, j);

        Water<L> at_rest{zero, zero, zero};
        if (data.from.pore_pressure != nullptr) {
            at_rest.pore_pressure = at(data.from.pore_pressure, 0);
            store(at_rest.pore_pressure, row.pore_pressure, j);
        }
        if (data.from.solid_fraction != nullptr) {
            at_rest.solid_fraction = at(data.from.solid_fraction, 0);
            store(at_rest.solid_fraction, row.solid_fraction, j);
        }
        const L is_dry = opaque(select(dry, one, zero));
        const L still = opaque(select(larger(magnitude(own_u), magnitude(own_v)) <= zero, one, zero)) * (one - is_dry);
        L rests = is_dry;
        if (any(still > zero)) {  // mostly of none
            const Resistance<L> resistance = resistance_at(data, i + j, depth, stretch, at_rest);
            const RestBalance<L> balance = rest_balance(rest_slope(x, inverse_cell), rest_slope(y, inverse_cell), bed_x,
                                                        bed_y, square_stretch, gravity, depth, resistance);
            rests = larger(rests, still * opaque(select(balance.driving <= balance.resisting, one, zero)));
        }
        store(rests, row.at_rest, j);
        store(bed_x, row.bed_x, j);
        store(bed_y, row.bed_y, j);
        const L upward = bed_x * own_u + bed_y * own_v;
        store(bed, row.bed, j);
        store(own_u * own_u + own_v * own_v + upward * upward, row.square, j);
        if (data.from.height != nullptr) {
            const L height = at(data.from.height, 0), climb = at(data.from.climb, 0);
            store(height, row.height, j);
            store(upward + climb, row.upward, j);
            store(flight_square(own_u, own_v, upward, {height, climb}, gravity), row.square, j);
            store(load<L>(row.at_rest, j) * opaque(select(height > zero, zero, one)), row.at_rest, j);
        }
        store(gravity * flatness, row.lift, j);
        store(at(data.from.spare, 0), row.spare, j);
        store(select(dry, zero, sqrt(own_u * own_u + own_v * own_v) + twice_wave), speed, j);
    }
}

}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
