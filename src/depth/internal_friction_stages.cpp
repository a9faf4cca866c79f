// The stages of internal friction. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/internal_friction_stages.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <array>
#include <hwy/highway.h>

#include "depth/formulas.hpp"
#include "depth/internal_friction_stages.hpp"
#include "simd/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {
namespace {

/// Converging debris is squeezed at most so much more than debris under its own weight, 1 / this.
constexpr float least_relief = 0.2F;

constexpr int friction_lanes = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
static_assert(tile_edge % friction_lanes == 0);
using Friction = simd::Lanes<friction_lanes>;

/// Calls f(i) for the registers of cells of strips that hold debris.
template <class F>
HWY_INLINE void for_each_register(const FrictionData& data, const Solver::Strip* first, const Solver::Strip* last,
                                  const F& f) {
    for (; first != last; ++first) {
        for (int k = 0; k < tile_edge; k += friction_lanes) {
            const std::ptrdiff_t i = first->at + k;
            if (friction_lanes < tile_edge && !any(Friction::load(data.cells.depth + i) > Friction(dry_depth)))
                continue;
            f(i);
        }
    }
}

/// A cell touches another where both hold debris, and a structure stands in both or in neither.
[[gnu::flatten]] void prepare(const FrictionData& data, const Solver::Strip* first, const Solver::Strip* last) {
    using L = Friction;
    const std::ptrdiff_t up = data.cells.stride;
    for_each_register(data, first, last, [&](std::ptrdiff_t i) HWY_ATTR {
        const float* const depth = data.cells.depth;
        // As numbers: choices between the same ones are taken apart lane by lane (see opaque).
        const auto wet = [&](std::ptrdiff_t j)
                             HWY_ATTR { return opaque(select(L::load(depth + j) > L(dry_depth), L(1), L(0))); };
        const L h = L::load(depth + i), built = L::load(data.built + i), here = wet(i);
        const auto touch = [&](std::ptrdiff_t j) HWY_ATTR {
            return here * wet(j) * opaque(select(built == L::load(data.built + j), L(1), L(0)));
        };
        const auto inverse = [](const L& count) HWY_ATTR { return select(count > L(1), L(0.5F), count); };
        const L east = touch(i + 1), west = touch(i - 1), north = touch(i + up), south = touch(i - up);
        east.store(data.touch_east + i);
        west.store(data.touch_west + i);
        north.store(data.touch_north + i);
        south.store(data.touch_south + i);
        inverse(east + west).store(data.half_x + i);
        inverse(north + south).store(data.half_y + i);
        const L x = L::load(data.cells.slope_x + i), y = L::load(data.cells.slope_y + i);
        (L(data.gravity) * h * h / (L(2) * (L(1) + x * x + y * y))).store(data.weight + i);
        if (data.cells.pore_pressure == nullptr) return;
        (L::load(data.cells.pore_pressure + i) * L(data.cells.pore_pressure_left)).store(data.ratio + i);
    });
}

[[gnu::flatten]] void find_gradients(const FrictionData& data, const Solver::Strip* first, const Solver::Strip* last) {
    using L = Friction;
    const std::ptrdiff_t up = data.cells.stride;
    for_each_register(data, first, last, [&](std::ptrdiff_t i) HWY_ATTR {
        const auto gradient = [&](const float* values, std::ptrdiff_t step, const float* before, const float* after,
                                  const float* half) HWY_ATTR {
            const L at = L::load(values + i);
            const L change = select(L::load(before + i) > L(0), at - L::load(values + i - step), L(0)) +
                             select(L::load(after + i) > L(0), L::load(values + i + step) - at, L(0));
            return change * L(data.inverse_cell) * L::load(half + i);
        };
        const auto find = [&](const float* values, float* eastward, float* northward) HWY_ATTR {
            gradient(values, 1, data.touch_west, data.touch_east, data.half_x).store(eastward + i);
            gradient(values, up, data.touch_south, data.touch_north, data.half_y).store(northward + i);
        };
        find(data.cells.u, data.u_east, data.u_north);
        find(data.cells.v, data.v_east, data.v_north);
    });
}

/// On the debris before faces between cells i and j, from that behind them, per density and length of a face, m3/s2:
/// along its normal and along it. `stretch`, `turn`: of the velocity along the normal and of that along the face, in
/// the direction of the normal; `along`, `skew`: gradients of both along the face.
HWY_INLINE void across(const FrictionData& data, std::ptrdiff_t i, std::ptrdiff_t j, const float* touch,
                       const Friction& stretch, const Friction& turn, const float* along, const float* skew,
                       float* pull, float* drag) {
    using L = Friction;
    const auto both = [&](const float* of) HWY_ATTR { return (L::load(of + i) + L::load(of + j)) * L(0.5F); };
    const auto less = [&](const float* of) HWY_ATTR { return smaller(L::load(of + i), L::load(of + j)); };
    const L aside = both(along);
    const L shear = (turn + both(skew)) * L(0.5F);
    const L rise = -(stretch + aside);  // volume stays
    const L rate = sqrt(stretch * stretch + aside * aside + rise * rise + L(2) * shear * shear);
    const L limit = L(data.limit) * (L(1) - both(data.ratio));
    const L pressure = less(data.weight) / larger(L(least_relief), L(1) - limit * rise / rate);
    const L over_rate = smaller(limit * pressure / rate, L(data.stiffest) * less(data.cells.depth));
    const L acts = select(rate > L(0), L::load(touch + i), L(0));
    select(acts > L(0), over_rate * (stretch - rise), L(0)).store(pull + i);
    select(acts > L(0), over_rate * shear, L(0)).store(drag + i);
}

[[gnu::flatten]] void find_tractions(const FrictionData& data, const Solver::Strip* first, const Solver::Strip* last) {
    using L = Friction;
    const std::ptrdiff_t up = data.cells.stride;
    for_each_register(data, first, last, [&](std::ptrdiff_t i) HWY_ATTR {
        const float *const u = data.cells.u + i, *const v = data.cells.v + i;
        const auto slope = [&](const float* from, std::ptrdiff_t step)
                               HWY_ATTR { return (L::load(from + step) - L::load(from)) * L(data.inverse_cell); };
        across(data, i, i + 1, data.touch_east, slope(u, 1), slope(v, 1), data.v_north, data.u_north, data.pull_east,
               data.drag_east);
        across(data, i, i + up, data.touch_north, slope(v, up), slope(u, up), data.u_east, data.v_east, data.pull_north,
               data.drag_north);
    });
}

[[gnu::flatten]] void take_velocities(const FrictionData& data, const Solver::Strip* first, const Solver::Strip* last,
                                      std::uint8_t* changes) {
    using L = Friction;
    const Solver::Cells& cells = data.cells;
    const std::ptrdiff_t up = cells.stride;
    for (; first != last; ++first, ++changes) {
        *changes = strip_unchanged;
        if (!first->active) continue;
        for (int k = 0; k < tile_edge; k += friction_lanes) L(0).store(data.faster + first->at + k);
        for_each_register(data, first, first + 1, [&](std::ptrdiff_t i) HWY_ATTR {
            const auto west = L::load(data.touch_west + i) > L(0), south = L::load(data.touch_south + i) > L(0);
            const auto sum = [&](const float* east, const float* north) HWY_ATTR {
                return L::load(east + i) - select(west, L::load(east + i - 1), L(0)) + L::load(north + i) -
                       select(south, L::load(north + i - up), L(0));
            };
            const L depth = L::load(cells.depth + i), u = L::load(cells.u + i), v = L::load(cells.v + i);
            const L x = sum(data.pull_east, data.drag_north), y = sum(data.drag_east, data.pull_north);
            const L new_u = u + L(data.over_mass) * x / depth, new_v = v + L(data.over_mass) * y / depth;
            const L other = select(new_u == u, L(0), L(1)) + select(new_v == v, L(0), L(1));
            const L changed = opaque(select(depth > L(dry_depth), other, L(0)));
            changed.store(data.faster + i);
            if (!any(changed > L(0))) return;
            const auto takes = changed > L(0);
            const L to_u = select(takes, new_u, u), to_v = select(takes, new_v, v);
            to_u.store(cells.u + i);
            to_v.store(cells.v + i);
            select(takes, new_u, L::load(cells.next_u + i)).store(cells.next_u + i);
            select(takes, new_v, L::load(cells.next_v + i)).store(cells.next_v + i);
            // What may be faster is computed in double precision for a few.
            const L wave = larger(to_u, -to_u) + larger(to_v, -to_v) + L(2) * sqrt(L(data.gravity) * depth);
            const L upward = to_u * L::load(cells.slope_x + i) + to_v * L::load(cells.slope_y + i);
            const L head = (to_u * to_u + to_v * to_v + upward * upward) / L(2 * data.gravity);
            const L line = L::load(cells.bed + i) + L(2) * depth + head;
            const L faster = select(wave > L(data.signal), changed, L(0)) + select(line > L(data.line), changed, L(0));
            *changes |= strip_changed | (any(faster > L(0)) ? strip_perhaps_faster : strip_unchanged);
        });
    }
}

FrictionStages make_friction_stages() {
    return {prepare, find_gradients, find_tractions, take_velocities};
}

}  // namespace
}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::depth {

HWY_EXPORT(make_friction_stages);

FrictionStages friction_stages() {
    return HWY_DYNAMIC_DISPATCH(make_friction_stages)();
}

}  // namespace talus::depth
#endif
