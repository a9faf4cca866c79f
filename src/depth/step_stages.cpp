// A stage of the depth-averaged step. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/step_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <array>
#include <cmath>
#include <hwy/highway.h>

#include "depth/flight.hpp"
#include "depth/formulas.hpp"
#include "depth/stages.hpp"
#include "sim/physics/resistance.hpp"
#include "simd/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {
namespace {

/// Share of its kinetic energy by which debris may exceed what it has been given: the model's pressure on steep ground
/// and the scheme both miss by that much where nothing is wrong.
constexpr float energy_error = 0.02F;
/// Most that is kept spare, over kinetic energy and that of pressure: what a shock took does not come back.
constexpr float largest_spare = 0.5F;

constexpr int lane_count = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
static_assert(tile_edge % lane_count == 0);
using L = simd::Lanes<lane_count>;

// Numbers of a row of a segment. Entry 0 is the cell west of it; the last vector may extend beyond the cell east of it.
constexpr int row_length = (largest_segment + 2) * tile_edge;
using Numbers = std::array<float, row_length>;

HWY_INLINE L load(const Numbers& from, int j) {
    return L::load(from.data() + j);
}
HWY_INLINE void store(const L& numbers, Numbers& to, int j) {
    numbers.store(to.data() + j);
}

/// What the faces see of a row of cells along an axis.
struct AxisRow {
    Numbers depth_before, depth_after, rise, normal_before, normal_after, across_before, across_after;
    Numbers limit_before, limit_after, wave;
    /// 1: the neighbour there is dry and stands above the surface, or is the stream of an inflow; 2: a structure.
    Numbers wall_before, wall_after;
};
struct Row {
    AxisRow x, y;
    Numbers at_rest, bed_x, bed_y;
    Numbers bed, square, lift, spare;  ///< the last three: see FaceSide, Motion
    Numbers pore_pressure;             ///< if it is carried
    Numbers height, upward;            ///< of flight, and the vertical velocity, if debris flies
};
/// Fluxes of a row of faces, that of energy with what is spare, and what the ground's curvature presses at them.
struct Faces {
    Numbers mass, normal, across, pressure_before, pressure_after, press, energy;
    Numbers pore_pressure;   ///< that goes with the mass, if it is carried
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
    L largest = L(0);
    L unknown = L(0);  ///< 0, or NaN if there was one
};

/// `pore_pressure`: of the debris, if it is carried.
HWY_INLINE Resistance<L> resistance_at(const StageData& data, std::ptrdiff_t i, const L& depth, const L& stretch,
                                       const L& pore_pressure) {
    const auto known = [&](const float* raster, float elsewhere) HWY_ATTR {
        if (raster == nullptr) return L(elsewhere);
        const L here = L::load(raster + i);
        return select(here == here, here, L(elsewhere));
    };
    Resistance<L> r;
    const L effective_share = data.from.pore_pressure == nullptr ? L(data.effective_share)
                                                                 : L(1) - pore_pressure * L(data.pore_pressure_left);
    r.friction = known(data.cover.friction, data.friction) * effective_share;
    r.strength = known(data.cover.strength, data.strength);
    r.inverse_turbulence = known(data.cover.inverse_turbulence, data.inverse_turbulence);
    if (data.turbulent_thickness > 0) {
        const L thickness = larger(depth, L(dry_depth)) / stretch;
        r.inverse_turbulence = r.inverse_turbulence * sim::cube_root(L(data.turbulent_thickness) / thickness);
    }
    r.stem_drag = known(data.cover.stem_drag, 0);
    r.viscosity = known(data.cover.viscosity, data.viscosity);
    return r;
}

HWY_INLINE void keep(const Line<L>& line, const L& wall_before, const L& wall_after, const L& wave,
                     const L& limit_before, const L& limit_after, AxisRow& row, int j) {
    const Sides<L> sides = sides_of(line);
    store(sides.depth_before, row.depth_before, j);
    store(sides.depth_after, row.depth_after, j);
    store(sides.rise, row.rise, j);
    store(sides.normal_before, row.normal_before, j);
    store(sides.normal_after, row.normal_after, j);
    store(sides.across_before, row.across_before, j);
    store(sides.across_after, row.across_after, j);
    store(limit_before, row.limit_before, j);
    store(limit_after, row.limit_after, j);
    store(wave, row.wave, j);
    store(wall_beside(line.depth, line.before, line.bed_before) + wall_before, row.wall_before, j);
    store(wall_beside(line.depth, line.after, line.bed_after) + wall_after, row.wall_after, j);
}

/// Reconstructs a row of cells; `i`: index of entry 0.
HWY_INLINE void reconstruct(const StageData& data, std::ptrdiff_t i, int cells, Row& row, Numbers& speed) {
    const std::ptrdiff_t up = data.stride;
    const L zero(0), one(1), dry_limit(dry_depth), gravity(data.gravity), inverse_cell(data.inverse_cell);
    const L flow_scale(0.999999F / (data.inverse_cell * data.time_step));
    for (int j = 0; j < cells; j += lane_count) {
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

        L pore_pressure = zero;
        if (data.from.pore_pressure != nullptr) {
            pore_pressure = at(data.from.pore_pressure, 0);
            store(pore_pressure, row.pore_pressure, j);
        }
        const Resistance<L> resistance = resistance_at(data, i + j, depth, stretch, pore_pressure);
        const RestBalance<L> balance = rest_balance(rest_slope(x, inverse_cell), rest_slope(y, inverse_cell), bed_x,
                                                    bed_y, square_stretch, gravity, depth, resistance);
        const L held = opaque(select(balance.driving <= balance.resisting, one, zero));
        const L still = opaque(select(larger(magnitude(own_u), magnitude(own_v)) <= zero, one, zero));
        store(larger(opaque(select(dry, one, zero)), still * held), row.at_rest, j);
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
            store(load(row.at_rest, j) * opaque(select(height > zero, zero, one)), row.at_rest, j);
        }
        store(gravity * flatness, row.lift, j);
        store(at(data.from.spare, 0), row.spare, j);
        store(select(dry, zero, sqrt(own_u * own_u + own_v * own_v) + twice_wave), speed, j);
    }
}

/// Fluxes between entry j of `before` and entry k of `after`; the normal velocity of the axis is u, if `along_x`.
HWY_INLINE void cross_faces(float gravity, const Row& before, int j, const Row& after, int k, bool along_x,
                            Faces& faces, int to) {
    const AxisRow &b = along_x ? before.x : before.y, &a = along_x ? after.x : after.y;
    const L lift = (load(before.lift, j) + load(after.lift, k)) * L(0.5F);
    // Where the ground bends, the velocity at the face belongs to neither slope: the energy line there lies between
    // those of the cells.
    const L fall = L(gravity) * (load(before.bed, j) - load(after.bed, k));
    const L line_before = load(before.square, j) + fall, line_after = load(after.square, k) - fall;
    const L line = (line_before + line_after) * L(0.5F);
    const auto square = [&](const L& normal, const L& across, const Row& row, int at, const L& own_line) HWY_ATTR {
        const L by_x = along_x ? normal : across, by_y = along_x ? across : normal;
        const L upward = load(row.bed_x, at) * by_x + load(row.bed_y, at) * by_y;
        return smaller(larger(normal * normal + across * across + upward * upward, smaller(own_line, line)),
                       larger(own_line, line));
    };
    const L normal_before = load(b.normal_after, j), across_before = load(b.across_after, j);
    const L normal_after = load(a.normal_before, k), across_after = load(a.across_before, k);
    FaceSide<L> from{load(b.depth_after, j),
                     normal_before,
                     across_before,
                     load(b.wave, j),
                     load(b.limit_after, j),
                     square(normal_before, across_before, before, j, line_before),
                     lift};
    FaceSide<L> onto{load(a.depth_before, k),
                     normal_after,
                     across_after,
                     load(a.wave, k),
                     load(a.limit_before, k),
                     square(normal_after, across_after, after, k, line_after),
                     lift};
    // Beside dry ground that stands above it, debris sees itself; beside a structure, its mirror image.
    const auto mirror = [](const L& wall, const FaceSide<L>& of, FaceSide<L>& in) HWY_ATTR {
        in.depth = select(wall > L(0), of.depth, in.depth);
        in.normal = select(wall > L(0), of.normal, in.normal);
        in.normal = select(wall > L(1), L(0) - of.normal, in.normal);
        in.across = select(wall > L(0), of.across, in.across);
        in.wave = select(wall > L(0), of.wave, in.wave);
        in.square = select(wall > L(0), of.square, in.square);
    };
    // Not both: of two neighbours, a wall is the dry one.
    // Debris on top of a structure falls off, over the debris beside it.
    const auto falls = [](const L& wall, const FaceSide<L>& top) HWY_ATTR {
        return opaque(select(wall > L(1), L(1), L(0))) * opaque(select(top.depth > L(0), L(1), L(0)));
    };
    const L falls_after = falls(load(a.wall_before, k), from), falls_before = falls(load(b.wall_after, j), onto);
    const L wall_before = load(a.wall_before, k) * (L(1) - falls_after);
    const L wall_after = load(b.wall_after, j) * (L(1) - falls_before);
    const FaceSide<L> unchanged = from;
    mirror(wall_before, onto, from);
    mirror(wall_after, unchanged, onto);
    onto.depth = onto.depth * (L(1) - falls_after);
    from.depth = from.depth * (L(1) - falls_before);
    Flux<L> flux = face_flux(from, onto);
    const L open = select(load(before.at_rest, j) * load(after.at_rest, k) > L(0), L(0), L(1));
    // Debris that passes has followed the ground of one cell and meets that of the other: half of the change is felt on
    // either side.
    const L turn_x = load(after.bed_x, k) - load(before.bed_x, j),
            turn_y = load(after.bed_y, k) - load(before.bed_y, j);
    const L turn = along_x ? turn_x * flux.carried_normal + turn_y * flux.carried_across
                           : turn_y * flux.carried_normal + turn_x * flux.carried_across;
    // Nor does debris climb to a face that its energy does not reach.
    const L reach =
        select(flux.mass > L(0), line_before + L(2) * lift * from.depth, line_after + L(2) * lift * onto.depth);
    const L passes = select(wall_before + wall_after > L(1), L(0), select(reach < L(0), L(0), open));
    store(flux.normal * open, faces.normal, to);
    store(flux.across * passes, faces.across, to);
    store(flux.pressure_before * open * (L(1) - falls_before), faces.pressure_before, to);
    store(flux.pressure_after * open * (L(1) - falls_after), faces.pressure_after, to);
    store(flux.mass * passes, faces.mass, to);
    store(L(0.5F) * flux.mass * turn * passes, faces.press, to);
    const L spare = select(flux.mass > L(0), load(before.spare, j), load(after.spare, k));
    store((flux.energy + flux.mass * spare) * passes, faces.energy, to);
}

/// What goes with the mass across faces whose fluxes are known: the pore pressure of where it comes from.
HWY_INLINE void cross_faces_with_pore_pressure(const Row& before, int j, const Row& after, int k, Faces& faces,
                                               int to) {
    const L mass = load(faces.mass, to);
    store(mass * select(mass > L(0), load(before.pore_pressure, j), load(after.pore_pressure, k)), faces.pore_pressure,
          to);
}

/// The same for debris that flies.
HWY_INLINE void cross_faces_in_flight(const Row& before, int j, const Row& after, int k, Faces& faces, int to) {
    const L mass = load(faces.mass, to);
    store(mass * select(mass > L(0), load(before.height, j), load(after.height, k)), faces.height, to);
    store(mass * select(mass > L(0), load(before.upward, j), load(after.upward, k)), faces.upward, to);
}

/// Pore pressure of debris of `depth` after a stage, with `content` of it times depth: rounding must not take it beyond
/// the values it is a mean of.
HWY_INLINE L mixed_pore_pressure(const L& content, const L& depth, const L& own, const L& low, const L& high) {
    const L mean = smaller(larger(content / larger(depth, L(1e-12F)), low), high);
    return select(depth > L(1e-12F), mean, own);
}

/// Pore pressure of a cell after this stage alone.
HWY_INLINE L pore_pressure_after(const StageData& data, const Scratch& scratch, int r, std::ptrdiff_t i, int j,
                                 const L& depth, const L& new_depth) {
    const Row& row = scratch.rows[static_cast<std::size_t>(r & 1)];
    const Numbers &x = scratch.x.pore_pressure, &south = scratch.y[static_cast<std::size_t>(r & 1)].pore_pressure;
    const Numbers& north = scratch.y[static_cast<std::size_t>((r + 1) & 1)].pore_pressure;
    const L dt(data.time_step), per_cell = dt * L(data.inverse_cell), own = load(row.pore_pressure, j);
    L content = depth * own - per_cell * (load(x, j) - load(x, j - 1) + (load(north, j) - load(south, j)));
    L low(1e30F), high(0);
    const auto bound_by = [&](const L& brings, const L& pore_pressure) HWY_ATTR {
        low = smaller(low, select(brings > L(0), pore_pressure, low));
        high = larger(high, select(brings > L(0), pore_pressure, high));
    };
    for (const std::ptrdiff_t beside : {std::ptrdiff_t{0}, std::ptrdiff_t{-1}, std::ptrdiff_t{1},
                                        -std::ptrdiff_t{data.stride}, std::ptrdiff_t{data.stride}}) {
        bound_by(L::load(data.from.depth + i + beside), L::load(data.from.pore_pressure + i + beside));
    }
    if (data.inflow.depth != nullptr) {
        const L comes = L::load(data.inflow.depth + i), fresh(data.fresh_pore_pressure);
        content = content + dt * comes * fresh;
        bound_by(comes, fresh);
    }
    return mixed_pore_pressure(content, new_depth, own, low, high);
}

/// What goes with the mass, per mass, after this stage alone.
HWY_INLINE L carried_after(const Numbers& own, const Numbers& x, const Numbers& south, const Numbers& north,
                           const L& depth, const L& new_depth, const L& per_cell, int j) {
    const L out = load(x, j) - load(x, j - 1) + (load(north, j) - load(south, j));
    return (depth * load(own, j) - per_cell * out) / larger(new_depth, L(dry_depth));
}

/// Updates lane_count cells at index i, entry j of the row.
HWY_INLINE void update(const StageData& data, Scratch& scratch, int r, std::ptrdiff_t i, int j, Fastest& fastest) {
    const Row& row = scratch.rows[static_cast<std::size_t>(r & 1)];
    const Faces &x = scratch.x, &south = scratch.y[static_cast<std::size_t>(r & 1)];
    const Faces& north = scratch.y[static_cast<std::size_t>((r + 1) & 1)];
    if (data.passes_east != nullptr) {
        load(x.mass, j).store(data.passes_east + i);
        load(north.mass, j).store(data.passes_north + i);
    }
    const L zero(0), half(0.5F), one(1), gravity(data.gravity), inverse_cell(data.inverse_cell);
    const L dt(data.time_step), per_cell = dt * inverse_cell;
    const L depth = L::load(data.from.depth + i), u = L::load(data.from.u + i), v = L::load(data.from.v + i);
    const L bed_x = load(row.bed_x, j), bed_y = load(row.bed_y, j);
    const L square_stretch = one + bed_x * bed_x + bed_y * bed_y, stretch = sqrt(square_stretch);
    const auto square = [&](const L& by_x, const L& by_y) HWY_ATTR {
        const L upward = bed_x * by_x + bed_y * by_y;
        return by_x * by_x + by_y * by_y + upward * upward;
    };

    const auto force = [&](const AxisRow& axis, const L& after, const L& before) HWY_ATTR {
        return (before - after - (load(axis.depth_before, j) + load(axis.depth_after, j)) * half * load(axis.rise, j)) *
               inverse_cell;
    };
    const L force_x = force(row.x, load(x.pressure_before, j), load(x.pressure_after, j - 1));
    const L force_y = force(row.y, load(north.pressure_before, j), load(south.pressure_after, j));
    // The gravity correction of Xia & Liang (2018): on a sheet cos^2 of the slope, on a lake 1.
    const L tilt = larger(zero, (bed_x * load(row.x.rise, j) + bed_y * load(row.y.rise, j)) * inverse_cell);
    const L free = one - load(row.at_rest, j);
    const L pull = free * gravity / (one + tilt);
    const L press =
        (load(x.press, j - 1) + load(x.press, j) + load(south.press, j) + load(north.press, j)) * inverse_cell;
    const L curvature = free * press / square_stretch;

    L new_depth = larger(
        zero, depth - per_cell * (load(x.mass, j) - load(x.mass, j - 1) + (load(north.mass, j) - load(south.mass, j))));
    const L out_x = load(x.normal, j) - load(x.normal, j - 1) + (load(north.across, j) - load(south.across, j));
    const L out_y = load(x.across, j) - load(x.across, j - 1) + (load(north.normal, j) - load(south.normal, j));
    const bool flies = data.from.height != nullptr;
    const L hold = gravity * depth / (one + tilt) + curvature;  // below zero the ground would have to hold the debris
    const L new_height = flies ? larger(zero, carried_after(row.height, x.height, south.height, north.height, depth,
                                                            new_depth, per_cell, j))
                               : zero;
    const L in_air = flies ? opaque(select(smaller(hold, zero - new_height) < zero, one, zero)) : zero;
    L push_x = pull * force_x - curvature * bed_x, push_y = pull * force_y - curvature * bed_y;
    if (flies) {
        push_x = push_x * (one - in_air);
        push_y = push_y * (one - in_air);
    }
    L m_x = depth * u - per_cell * out_x + dt * push_x;
    L m_y = depth * v - per_cell * out_y + dt * push_y;
    L bound = zero;
    // What debris may move with: its kinetic energy and what is spare, and what comes through the faces and falls there
    // from the bed of one cell to that of the other, over density and area. What depth alone has (lift h^2 / 2) is left
    // out, since single precision would lose the rest in it.
    const L lift = load(row.lift, j), head = lift * depth, bed = L::load(data.bed + i);
    const L square_speed = flies ? load(row.square, j) : square(u, v);
    const std::ptrdiff_t up = data.stride;
    const auto out = [&](const Faces& faces, int at, std::ptrdiff_t beside) HWY_ATTR {
        return load(faces.energy, at) +
               load(faces.mass, at) * (half * gravity * (L::load(data.bed + (i + beside)) - bed) - head);
    };
    L energy = depth * (half * square_speed + load(row.spare, j)) -
               per_cell * (out(x, j, 1) - out(x, j - 1, -1) + (out(north, j, up) - out(south, j, -up)));
    if (data.inflow.depth != nullptr) {
        const L comes = L::load(data.inflow.depth + i);
        const L comes_x = L::load(data.inflow.momentum_x + i), comes_y = L::load(data.inflow.momentum_y + i);
        new_depth = new_depth + dt * comes;
        m_x = m_x + dt * comes_x;
        m_y = m_y + dt * comes_y;
        bound = sqrt(comes_x * comes_x + comes_y * comes_y) / larger(comes, L(1e-12F));
        // It enters at the upper edge of the cell, with the pressure of its depth.
        const L fall = half * gravity * (magnitude(bed_x) + magnitude(bed_y)) / inverse_cell;
        energy = energy + dt * (half * square(comes_x, comes_y) / larger(comes, L(1e-12F)) +
                                comes * (fall + lift * (new_depth - depth)));
    }

    const bool carries = data.from.pore_pressure != nullptr;
    L pore_pressure = carries ? pore_pressure_after(data, scratch, r, i, j, depth, new_depth) : zero;

    L normal_force = larger(zero, hold), lands = zero;
    Flight<L> flight{zero, zero};
    if (flies) {
        const L inverse_depth = one / larger(new_depth, L(dry_depth));
        const L rises = carried_after(row.upward, x.upward, south.upward, north.upward, depth, new_depth, per_cell, j);
        flight = fly(new_height, rises, (bed_x * m_x + bed_y * m_y) * inverse_depth, gravity, dt);
        lands = in_air * opaque(select(flight.height > zero, zero, one));
        // What is normal to the ground is lost there, by an impulse to which friction belongs as to any other.
        const L impulse = lands * new_depth * larger(zero, zero - flight.climb) / square_stretch;
        m_x = m_x - impulse * bed_x;
        m_y = m_y - impulse * bed_y;
        energy = energy - half * impulse * magnitude(flight.climb);
        bound = bound + impulse * inverse_depth * (magnitude(bed_x) + magnitude(bed_y));
        normal_force = select(in_air > zero, impulse / dt, normal_force);
        const L stays = in_air - lands;
        flight = {stays * flight.height, stays * flight.climb};
    }
    const L m_up = bed_x * m_x + bed_y * m_y, momentum = sqrt(m_x * m_x + m_y * m_y + m_up * m_up);
    L left = resisted(resistance_at(data, i, new_depth, stretch, pore_pressure), gravity, momentum, new_depth,
                      normal_force, stretch, dt);
    if (flies) left = select(in_air - lands > zero, momentum, left);
    energy = energy - (momentum - left) * sqrt(square_speed);
    const L moves = smaller(new_depth - L(dry_depth), left);
    const L to_speed =
        select(moves > zero, left / (larger(momentum, L(1e-30F)) * larger(new_depth, L(dry_depth))), zero);
    L new_u = m_x * to_speed, new_v = m_y * to_speed;
    // Emptied cells keep no momentum without mass: no faster than the fastest around, its front and free fall.
    bound = larger(bound, load(scratch.speed[static_cast<std::size_t>(r % 3)], j));
    bound = larger(bound, larger(load(scratch.speed[static_cast<std::size_t>(r % 3)], j - 1),
                                 load(scratch.speed[static_cast<std::size_t>(r % 3)], j + 1)));
    bound = larger(bound, larger(load(scratch.speed[static_cast<std::size_t>((r + 1) % 3)], j),
                                 load(scratch.speed[static_cast<std::size_t>((r + 2) % 3)], j)));
    bound = bound + gravity * dt;
    const L speed = sqrt(new_u * new_u + new_v * new_v);
    const L slower = select(speed > bound, bound / larger(speed, L(1e-30F)), one);
    new_u = new_u * slower;
    new_v = new_v * slower;

    L to_depth = new_depth;
    const L deeper = new_depth - depth;
    const L on_its_way = opaque(select(moves > zero, one, zero));
    if (flies) flight = {flight.height * on_its_way, flight.climb * on_its_way};
    const auto square_of = [&](const L& by_x, const L& by_y, const Flight<L>& of) HWY_ATTR {
        return flies ? flight_square(by_x, by_y, bed_x * by_x + bed_y * by_y, of, gravity) : square(by_x, by_y);
    };
    L spare = energy - half * (lift * deeper * deeper + new_depth * square_of(new_u, new_v, flight));
    const auto difference = [](const L& a, const L& b) HWY_ATTR { return magnitude(a - b); };
    L change = load(scratch.change, j) + difference(new_depth, depth) + difference(new_u, u) + difference(new_v, v);
    if (data.second) {
        const L old_depth = L::load(data.to.depth + i);
        const L old_u = L::load(data.to.u + i), old_v = L::load(data.to.v + i);
        to_depth = half * (old_depth + new_depth);
        const L scale =
            select(smaller(moves, to_depth - L(dry_depth)) > zero, half / larger(to_depth, L(dry_depth)), zero);
        new_u = (old_depth * old_u + new_depth * new_u) * scale;
        new_v = (old_depth * old_v + new_depth * new_v) * scale;
        Flight<L> old_flight{zero, zero};
        L lost = zero;
        if (flies) {
            old_flight = {L::load(data.to.height + i), L::load(data.to.climb + i)};
            const L aloft = opaque(select(flight.height > zero, one, zero));
            const L height = (old_depth * old_flight.height + new_depth * flight.height) * scale;
            const L climb = (old_depth * old_flight.climb + new_depth * flight.climb) * scale;
            // On the ground at the end of the step: half of the first stage may not be.
            const L strikes = (one - aloft) * climb / square_stretch;
            new_u = new_u + strikes * bed_x;
            new_v = new_v + strikes * bed_y;
            lost = to_depth * strikes * climb;
            flight = {aloft * height, aloft * climb};
            change = change + difference(flight.height, old_flight.height) + difference(flight.climb, old_flight.climb);
        }
        // No faster than that allows. All terms are twice those of a stage, which count half.
        const L old_spare = L::load(data.to.spare + i), rise = new_depth - old_depth;
        const L allowed = old_depth * (half * square_of(old_u, old_v, old_flight) + old_spare) + energy +
                          lift * (L(0.25F) * rise * rise - half * deeper * deeper) - lost;
        // Nor faster than from the highest energy line of all.
        L wanted = to_depth * square_of(new_u, new_v, flight);
        const L fall = L(data.highest_line) - bed;
        const L most = larger(zero, smaller(allowed * L(1 / (1 - energy_error)), L(2) * gravity * to_depth * fall));
        if (flies) {
            // Nor higher: where debris is held up at a fall, the ground seems to sink below it.
            const L higher = larger(zero, wanted - most) / (L(2) * gravity * larger(to_depth, L(dry_depth)));
            const L height = larger(zero, flight.height - higher);
            const L aloft = opaque(select(height > zero, one, zero));
            flight = {height, aloft * flight.climb};
            wanted = to_depth * square_of(new_u, new_v, flight);
        }
        const L share = select(wanted > most, sqrt(most / larger(wanted, L(1e-30F))), one);
        new_u = new_u * share;
        new_v = new_v * share;
        const L taken = smaller(wanted, most);
        spare = half * smaller(allowed - taken, L(largest_spare) * (taken + lift * to_depth * to_depth));
        change = change + difference(to_depth, old_depth) + difference(new_u, old_u) + difference(new_v, old_v);
        const L signal = select(to_depth <= L(dry_depth), zero,
                                magnitude(new_u) + magnitude(new_v) + L(2) * sqrt(gravity * to_depth));
        fastest.largest = larger(fastest.largest, signal);
        fastest.unknown = fastest.unknown + signal * zero;
    }
    spare = select(to_depth <= L(dry_depth), zero, spare / larger(to_depth, L(dry_depth)));
    spare.store(data.to.spare + i);
    if (flies) {
        change = change + flight.height + magnitude(flight.climb);
        flight.height.store(data.to.height + i);
        flight.climb.store(data.to.climb + i);
    }
    if (carries) {
        change = change + difference(pore_pressure, load(row.pore_pressure, j));
        if (data.second) {
            const L old_depth = L::load(data.to.depth + i), before = L::load(data.to.pore_pressure + i);
            const L old = select(old_depth > zero, before, pore_pressure);
            const L content = half * (old_depth * old + new_depth * pore_pressure);
            pore_pressure = mixed_pore_pressure(content, to_depth, pore_pressure, smaller(old, pore_pressure),
                                                larger(old, pore_pressure));
            change = change + difference(pore_pressure, before);
        }
        pore_pressure.store(data.to.pore_pressure + i);
    }
    store(change, scratch.change, j);
    to_depth.store(data.to.depth + i);
    new_u.store(data.to.u + i);
    new_v.store(data.to.v + i);
}

[[gnu::flatten]] float advance(const StageData& data, const Segment& segment, std::uint8_t* changed) {
    Scratch scratch{};
    const int width = segment.tiles * tile_edge;
    const std::ptrdiff_t first =
        static_cast<std::ptrdiff_t>(segment.tile_row) * tile_edge * data.stride + segment.first_tile * tile_edge;
    const auto row_of = [&](int r) HWY_ATTR -> Row& { return scratch.rows[static_cast<std::size_t>(r & 1)]; };
    const bool carries = data.from.pore_pressure != nullptr, flies = data.from.height != nullptr;
    Fastest fastest;
    // Row r of the segment is r + 1 here, so that the row before it is 0.
    for (int r = 0; r < tile_edge + 2; ++r) {
        if (r >= 2) {
            const Row& row = row_of(r - 1);
            for (int j = 0; j <= width; j += lane_count) {
                cross_faces(data.gravity, row, j, row, j + 1, true, scratch.x, j);
                if (carries) cross_faces_with_pore_pressure(row, j, row, j + 1, scratch.x, j);
                if (flies) cross_faces_in_flight(row, j, row, j + 1, scratch.x, j);
            }
        }
        reconstruct(data, first + (r - 1) * static_cast<std::ptrdiff_t>(data.stride) - 1, width + 2, row_of(r),
                    scratch.speed[static_cast<std::size_t>(r % 3)]);
        if (r == 0) continue;
        Faces& faces = scratch.y[static_cast<std::size_t>(r & 1)];
        for (int j = 1; j <= width; j += lane_count) {
            cross_faces(data.gravity, row_of(r - 1), j, row_of(r), j, false, faces, j);
            if (carries) cross_faces_with_pore_pressure(row_of(r - 1), j, row_of(r), j, faces, j);
            if (flies) cross_faces_in_flight(row_of(r - 1), j, row_of(r), j, faces, j);
        }
        if (r < 2) continue;
        for (int j = 1; j <= width; j += lane_count) {
            const std::ptrdiff_t i = first + (r - 2) * static_cast<std::ptrdiff_t>(data.stride) + (j - 1);
            update(data, scratch, r - 1, i, j, fastest);
        }
    }
    for (int j = 1; j <= width; ++j) {
        if (scratch.change[static_cast<std::size_t>(j)] > 0) changed[(j - 1) / tile_edge] = 1;
    }
    float result = 0;
    for (int lane = 0; lane < lane_count; ++lane) {
        const float one = fastest.largest.at(lane) + fastest.unknown.at(lane);
        if (!(one <= result)) result = one;
        if (std::isnan(one)) break;
    }
    return result;
}

Stages make_stages() {
    return {advance, hwy::TargetName(HWY_TARGET)};
}

}  // namespace
}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::depth {

HWY_EXPORT(make_stages);

Stages stages_for_processor() {
    return HWY_DYNAMIC_DISPATCH(make_stages)();
}

}  // namespace talus::depth
#endif
