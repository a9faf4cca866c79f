// Cells after a stage of the depth-averaged step, from what crosses their faces and what resists. Included once per
// instruction set.
#if defined(TALUS_DEPTH_UPDATE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_DEPTH_UPDATE_INL
#undef TALUS_DEPTH_UPDATE_INL
#else
#define TALUS_DEPTH_UPDATE_INL
#endif

#include <hwy/highway.h>

#include "depth/flight.hpp"
#include "depth/formulas.hpp"
#include "depth/rows-inl.hpp"
#include "depth/soil.hpp"
#include "depth/stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {

/// Share of its kinetic energy by which debris may exceed what it has been given: the model's pressure on steep ground
/// and the scheme both miss by that much where nothing is wrong.
constexpr float energy_error = 0.02F;
/// Most that is kept spare, over kinetic energy and that of pressure: what a shock took does not come back.
constexpr float largest_spare = 0.5F;

/// Pore pressure or solid fraction of debris of `depth` after a stage, with `content` of it times depth: rounding must
/// not take it beyond the values it is a mean of.
template <class L>
HWY_INLINE L mixed(const L& content, const L& depth, const L& own, const L& low, const L& high) {
    const L mean = smaller(larger(content / larger(depth, L(1e-12F)), low), high);
    return select(depth > L(1e-12F), mean, own);
}

/// Pore pressure, or solid fraction, of a cell after this stage alone. `raster`: of it; `fresh`: of what comes in.
template <class L>
HWY_INLINE L mixed_after(const StageData& data, const Scratch& scratch, Numbers Row::*of_row, Numbers Faces::*of_faces,
                         const float* raster, const L& fresh, int r, std::ptrdiff_t i, int j, const L& depth,
                         const L& new_depth) {
    const Row& row = scratch.rows[static_cast<std::size_t>(r & 1)];
    const Numbers &x = scratch.x.*of_faces, &south = scratch.y[static_cast<std::size_t>(r & 1)].*of_faces;
    const Numbers& north = scratch.y[static_cast<std::size_t>((r + 1) & 1)].*of_faces;
    const L dt(data.time_step), per_cell = dt * L(data.inverse_cell), own = load<L>(row.*of_row, j);
    L content = depth * own - per_cell * (load<L>(x, j) - load<L>(x, j - 1) + (load<L>(north, j) - load<L>(south, j)));
    L low(1e30F), high(0);
    const auto bound_by = [&](const L& brings, const L& value) HWY_ATTR {
        low = smaller(low, select(brings > L(0), value, low));
        high = larger(high, select(brings > L(0), value, high));
    };
    for (const std::ptrdiff_t beside : {std::ptrdiff_t{0}, std::ptrdiff_t{-1}, std::ptrdiff_t{1},
                                        -std::ptrdiff_t{data.stride}, std::ptrdiff_t{data.stride}}) {
        bound_by(L::load(data.from.depth + i + beside), L::load(raster + i + beside));
    }
    if (data.inflow.depth != nullptr) {
        const L comes = L::load(data.inflow.depth + i);
        content = content + dt * comes * fresh;
        bound_by(comes, fresh);
    }
    return mixed(content, new_depth, own, low, high);
}

/// After this stage alone.
template <class L>
HWY_INLINE Water<L> water_after(const StageData& data, const Scratch& scratch, int r, std::ptrdiff_t i, int j,
                                const L& depth, const L& new_depth) {
    L ratio(data.fresh_pore_pressure);
    Water<L> water{L(0), L(0), L(0)};
    if (data.from.solid_fraction != nullptr) {
        L fresh(data.soil.solid_fraction);
        if (data.inflow.grains != nullptr) {
            fresh = L::load(data.inflow.grains + i) / larger(L::load(data.inflow.depth + i), L(1e-12F));
        }
        if (!(data.fresh_pore_pressure > 0)) ratio = hydrostatic_ratio(data.soil, fresh);
        water.solid_fraction = mixed_after(data, scratch, &Row::solid_fraction, &Faces::solid_fraction,
                                           data.from.solid_fraction, fresh, r, i, j, depth, new_depth);
    }
    water.pore_pressure = mixed_after(data, scratch, &Row::pore_pressure, &Faces::pore_pressure,
                                      data.from.pore_pressure, ratio, r, i, j, depth, new_depth);
    return water;
}

/// Soil at the end of a step in which pore pressure evolves. Where the flow stretches it thins: dh/dt = -h div u, by
/// the velocities of the debris around.
template <class L>
HWY_INLINE sim::Soil<L> evolved(const StageData& data, std::ptrdiff_t i, const Water<L>& water, const L& depth,
                                const L& stretch) {
    const L zero(0), one(1), half(0.5F), two(2), dry(dry_depth);
    const auto gradient = [&](const float* velocity, std::ptrdiff_t step) HWY_ATTR {
        const L own = L::load(velocity + i);
        const L wet_before = opaque(select(L::load(data.from.depth + i - step) > dry, one, zero));
        const L wet_after = opaque(select(L::load(data.from.depth + i + step) > dry, one, zero));
        return (wet_before * (own - L::load(velocity + i - step)) + wet_after * (L::load(velocity + i + step) - own)) *
               L(data.inverse_cell) / larger(one, wet_before + wet_after);
    };
    const L spread = (gradient(data.from.u, 1) + gradient(data.from.v, data.stride)) * L(data.time_step);
    const L thickness = larger(depth / stretch, L(thinnest_soil));
    const L before = thickness * smaller(two, larger(half, one + spread));
    const sim::Soil<L> after = sim::evolve(data.soil, {water.solid_fraction, water.pore_pressure, before, zero},
                                           L(data.gravity) / stretch, thickness, water.speed, L(data.time_step));
    const auto wet = depth > dry;
    return {select(wet, after.solid_fraction, water.solid_fraction),
            select(wet, after.pressure_ratio, water.pore_pressure), thickness, after.dilatancy};
}

/// What goes with the mass, per mass, after this stage alone.
template <class L>
HWY_INLINE L carried_after(const Numbers& own, const Numbers& x, const Numbers& south, const Numbers& north,
                           const L& depth, const L& new_depth, const L& per_cell, int j) {
    const L out = load<L>(x, j) - load<L>(x, j - 1) + (load<L>(north, j) - load<L>(south, j));
    return (depth * load<L>(own, j) - per_cell * out) / larger(new_depth, L(dry_depth));
}

/// Leaves L::size cells empty.
template <class L>
HWY_INLINE void leave_empty(const StageData& data, std::ptrdiff_t i) {
    const L zero(0);
    for (float* raster : {data.to.depth, data.to.u, data.to.v, data.to.spare}) zero.store(raster + i);
    if (data.passes_east != nullptr) {
        zero.store(data.passes_east + i);
        zero.store(data.passes_north + i);
    }
}

/// Updates L::size cells at index i, entry j of the row.
template <class L>
HWY_INLINE void update(const StageData& data, Scratch& scratch, int r, std::ptrdiff_t i, int j, Fastest& fastest) {
    const Row& row = scratch.rows[static_cast<std::size_t>(r & 1)];
    const Faces &x = scratch.x, &south = scratch.y[static_cast<std::size_t>(r & 1)];
    const Faces& north = scratch.y[static_cast<std::size_t>((r + 1) & 1)];
    if (data.passes_east != nullptr) {
        load<L>(x.mass, j).store(data.passes_east + i);
        load<L>(north.mass, j).store(data.passes_north + i);
    }
    const L zero(0), half(0.5F), one(1), gravity(data.gravity), inverse_cell(data.inverse_cell);
    const L dt(data.time_step), per_cell = dt * inverse_cell;
    const L depth = L::load(data.from.depth + i), u = L::load(data.from.u + i), v = L::load(data.from.v + i);
    const L bed_x = load<L>(row.bed_x, j), bed_y = load<L>(row.bed_y, j);
    const L square_stretch = one + bed_x * bed_x + bed_y * bed_y, stretch = sqrt(square_stretch);
    const auto square = [&](const L& by_x, const L& by_y) HWY_ATTR {
        const L upward = bed_x * by_x + bed_y * by_y;
        return by_x * by_x + by_y * by_y + upward * upward;
    };

    const auto force = [&](const AxisRow& axis, const L& after, const L& before) HWY_ATTR {
        return (before - after -
                (load<L>(axis.before.depth, j) + load<L>(axis.after.depth, j)) * half * load<L>(axis.rise, j)) *
               inverse_cell;
    };
    const L force_x = force(row.x, load<L>(x.pressure_before, j), load<L>(x.pressure_after, j - 1));
    const L force_y = force(row.y, load<L>(north.pressure_before, j), load<L>(south.pressure_after, j));
    // The gravity correction of Xia & Liang (2018): on a sheet cos^2 of the slope, on a lake 1.
    const L tilt = larger(zero, (bed_x * load<L>(row.x.rise, j) + bed_y * load<L>(row.y.rise, j)) * inverse_cell);
    const L free = one - load<L>(row.at_rest, j);
    const L pull = free * gravity / (one + tilt);
    const L press =
        (load<L>(x.press, j - 1) + load<L>(x.press, j) + load<L>(south.press, j) + load<L>(north.press, j)) *
        inverse_cell;
    const L curvature = free * press / square_stretch;

    L new_depth = larger(zero, depth - per_cell * (load<L>(x.mass, j) - load<L>(x.mass, j - 1) +
                                                   (load<L>(north.mass, j) - load<L>(south.mass, j))));
    const L out_x =
        load<L>(x.normal, j) - load<L>(x.normal, j - 1) + (load<L>(north.across, j) - load<L>(south.across, j));
    const L out_y =
        load<L>(x.across, j) - load<L>(x.across, j - 1) + (load<L>(north.normal, j) - load<L>(south.normal, j));
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
    const L lift = load<L>(row.lift, j), head = lift * depth, bed = L::load(data.bed + i);
    const L square_speed = flies ? load<L>(row.square, j) : square(u, v);
    const std::ptrdiff_t up = data.stride;
    const auto out = [&](const Faces& faces, int at, std::ptrdiff_t beside) HWY_ATTR {
        return load<L>(faces.energy, at) +
               load<L>(faces.mass, at) * (half * gravity * (L::load(data.bed + (i + beside)) - bed) - head);
    };
    L energy = depth * (half * square_speed + load<L>(row.spare, j)) -
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
    const bool evolves = data.from.solid_fraction != nullptr;
    Water<L> water{zero, zero, zero};
    if (carries) water = water_after(data, scratch, r, i, j, depth, new_depth);
    if (evolves) water.speed = sqrt(square(u, v));

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
    L left = resisted(resistance_at(data, i, new_depth, stretch, water), gravity, momentum, new_depth, normal_force,
                      stretch, dt);
    if (flies) left = select(in_air - lands > zero, momentum, left);
    energy = energy - (momentum - left) * sqrt(square_speed);
    const L moves = smaller(new_depth - L(dry_depth), left);
    const L to_speed =
        select(moves > zero, left / (larger(momentum, L(1e-30F)) * larger(new_depth, L(dry_depth))), zero);
    L new_u = m_x * to_speed, new_v = m_y * to_speed;
    // Emptied cells keep no momentum without mass: no faster than the fastest around, its front and free fall.
    bound = larger(bound, load<L>(scratch.speed[static_cast<std::size_t>(r % 3)], j));
    bound = larger(bound, larger(load<L>(scratch.speed[static_cast<std::size_t>(r % 3)], j - 1),
                                 load<L>(scratch.speed[static_cast<std::size_t>(r % 3)], j + 1)));
    bound = larger(bound, larger(load<L>(scratch.speed[static_cast<std::size_t>((r + 1) % 3)], j),
                                 load<L>(scratch.speed[static_cast<std::size_t>((r + 2) % 3)], j)));
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
    L change = load<L>(scratch.change, j) + difference(new_depth, depth) + difference(new_u, u) + difference(new_v, v);
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
        const L signal = select(opaque(to_depth) <= L(dry_depth), zero,
                                magnitude(new_u) + magnitude(new_v) + L(2) * sqrt(gravity * to_depth));
        fastest.take(signal);
    }
    spare = select(to_depth <= L(dry_depth), zero, spare / larger(to_depth, L(dry_depth)));
    spare.store(data.to.spare + i);
    if (flies) {
        change = change + flight.height + magnitude(flight.climb);
        flight.height.store(data.to.height + i);
        flight.climb.store(data.to.climb + i);
    }
    if (carries) {
        change = change + difference(water.pore_pressure, load<L>(row.pore_pressure, j));
        if (data.second) {
            const L old_depth = L::load(data.to.depth + i), before = L::load(data.to.pore_pressure + i);
            const auto mean = [&](const L& kept, const L& now) HWY_ATTR {
                const L old = select(old_depth > zero, kept, now);
                return mixed(half * (old_depth * old + new_depth * now), to_depth, now, smaller(old, now),
                             larger(old, now));
            };
            water.pore_pressure = mean(before, water.pore_pressure);
            if (evolves) {
                water.solid_fraction = mean(L::load(data.to.solid_fraction + i), water.solid_fraction);
                water.speed = sqrt(square(new_u, new_v));
                const sim::Soil<L> soil = evolved(data, i, water, to_depth, stretch);
                water = {soil.pressure_ratio, soil.solid_fraction, zero};
            }
            change = change + difference(water.pore_pressure, before);
        }
        water.pore_pressure.store(data.to.pore_pressure + i);
        if (evolves) water.solid_fraction.store(data.to.solid_fraction + i);
    }
    store(change, scratch.change, j);
    to_depth.store(data.to.depth + i);
    new_u.store(data.to.u + i);
    new_v.store(data.to.v + i);
}

}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
