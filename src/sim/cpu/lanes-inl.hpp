// Shared by every file of stages; included once per instruction set.
#if defined(TALUS_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_LANES_INL
#undef TALUS_LANES_INL
#else
#define TALUS_LANES_INL
#endif

#include <concepts>
#include <hwy/highway.h>

#include "sim/cpu/work.hpp"
#include "simd/lanes.hpp"

/// Everything that a stage calls is inlined into it, so formulas of any header are compiled for its instruction set.
#define TALUS_STAGE [[gnu::flatten]]

HWY_BEFORE_NAMESPACE();
namespace talus::sim::cpu::HWY_NAMESPACE {

constexpr int lane_count = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
static_assert(block_size % lane_count == 0);
using L = simd::Lanes<lane_count>;
using V3 = Vec3<L>;
using Stress = Deviator<L>;
using Mask = simd::LaneMask<lane_count>;

/// Calls f(i) for the first of every lane_count particles of the blocks.
template <class F>
HWY_INLINE void for_each_lanes(std::size_t first_block, std::size_t last_block, const F& f) {
    for (std::size_t i = first_block * block_size; i < last_block * block_size; i += lane_count) f(i);
}

/// The last block may extend beyond the number of particles.
HWY_INLINE Mask is_present(const State& state, std::size_t i) {
    L place;
    for (int lane = 0; lane < lane_count; ++lane) place.set(lane, static_cast<float>(lane));
    return place < L(state.count > i ? state.count - i : 0);
}

HWY_INLINE L load(const std::vector<float>& from, std::size_t i) {
    return L::load(from.data() + i);
}
HWY_INLINE V3 load(const VectorArray& from, std::size_t i) {
    return {load(from.x, i), load(from.y, i), load(from.z, i)};
}
HWY_INLINE void store(const L& numbers, std::vector<float>& to, std::size_t i) {
    numbers.store(to.data() + i);
}
HWY_INLINE void store(const V3& v, VectorArray& to, std::size_t i) {
    store(v.x, to.x, i);
    store(v.y, to.y, i);
    store(v.z, to.z, i);
}
HWY_INLINE Stress load(const DeviatorArray& from, std::size_t i) {
    return {load(from.xx, i), load(from.yy, i), load(from.xy, i), load(from.xz, i), load(from.yz, i)};
}
HWY_INLINE void store(const Stress& s, DeviatorArray& to, std::size_t i) {
    store(s.xx, to.xx, i);
    store(s.yy, to.yy, i);
    store(s.xy, to.xy, i);
    store(s.xz, to.xz, i);
    store(s.yz, to.yz, i);
}
/// `set` or `clear`, as the flags of the particles say.
HWY_INLINE L flags(const std::vector<std::uint8_t>& from, std::size_t i, float set, float clear) {
    L result(clear);
    for (int lane = 0; lane < lane_count; ++lane) {
        if (from[i + static_cast<std::size_t>(lane)]) result.set(lane, set);
    }
    return result;
}
template <std::derived_from<simd::Oct> Row>
HWY_INLINE Octs<L> load(const std::vector<Row>& from, std::size_t i) {
    return simd::load_octs<lane_count>(from.data() + i);
}
template <std::derived_from<simd::Oct> Row>
HWY_INLINE Quads<L> load_low(const std::vector<Row>& from, std::size_t i) {
    return simd::load_quads<lane_count, 0>(from.data() + i);
}
template <std::derived_from<simd::Oct> Row>
HWY_INLINE Quads<L> load_high(const std::vector<Row>& from, std::size_t i) {
    return simd::load_quads<lane_count, 1>(from.data() + i);
}
template <std::derived_from<simd::Oct> Row>
HWY_INLINE void store_low(const Quads<L>& quads, std::vector<Row>& to, std::size_t i) {
    simd::store_quads<lane_count, 0>(quads, to.data() + i);
}
template <std::derived_from<simd::Oct> Row>
HWY_INLINE void store_high(const Quads<L>& quads, std::vector<Row>& to, std::size_t i) {
    simd::store_quads<lane_count, 1>(quads, to.data() + i);
}
/// A vector and a fourth number.
HWY_INLINE Quads<L> with(const V3& v, const L& w) {
    return {v.x, v.y, v.z, w};
}
HWY_INLINE V3 vector_of(const Quads<L>& quads) {
    return {quads.x, quads.y, quads.z};
}

/// The neighbours of lane_count particles, side by side.
struct LaneLists {
    const std::uint32_t* neighbour;
    float *gradient_x, *gradient_y, *gradient_z;
    std::uint32_t length;
    L count;

    HWY_INLINE LaneLists(NeighbourLists& lists, std::size_t i)
        : length(lists.length[i / block_size]), count(load(lists.count, i)) {
        const std::size_t at = lists.start[i / block_size] + i % block_size;
        neighbour = lists.neighbour.data() + at;
        gradient_x = lists.gradient.x.data() + at;
        gradient_y = lists.gradient.y.data() + at;
        gradient_z = lists.gradient.z.data() + at;
    }
    /// Calls f(k, remaining) for every entry; `remaining` is 0 or less past the end of a list that is shorter than its
    /// block's longest and is padded with the particle itself.
    template <class F>
    HWY_INLINE void for_each(const F& f) const {
        L remaining = count;
        const L one(1);
        for (std::uint32_t k = 0; k < length; ++k) {
            f(k, remaining);
            remaining = remaining - one;
        }
    }
    /// Lanes whose entry is `first` or a later particle.
    HWY_INLINE Mask from_on(std::uint32_t k, std::uint32_t first) const {
        Mask::Ints entry;
        __builtin_memcpy(&entry, neighbour + k * block_size, sizeof entry);
        return Mask(Mask::Ints(entry >= static_cast<std::int32_t>(first)));
    }
    HWY_INLINE V3 gradient(std::uint32_t k) const {
        const std::size_t at = k * block_size;
        return {L::load(gradient_x + at), L::load(gradient_y + at), L::load(gradient_z + at)};
    }
    HWY_INLINE void keep(std::uint32_t k, const V3& gradient) const {
        const std::size_t at = k * block_size;
        gradient.x.store(gradient_x + at);
        gradient.y.store(gradient_y + at);
        gradient.z.store(gradient_z + at);
    }
    template <std::derived_from<simd::Oct> Row>
    HWY_INLINE Octs<L> gather(const std::vector<Row>& from, std::uint32_t k) const {
        return simd::octs_at<lane_count>(from.data(), neighbour + k * block_size);
    }
    template <std::derived_from<simd::Oct> Row>
    HWY_INLINE Quads<L> gather_low(const std::vector<Row>& from, std::uint32_t k) const {
        return simd::quads_at<lane_count, 0>(from.data(), neighbour + k * block_size);
    }
    template <std::derived_from<simd::Oct> Row>
    HWY_INLINE Quads<L> gather_high(const std::vector<Row>& from, std::uint32_t k) const {
        return simd::quads_at<lane_count, 1>(from.data(), neighbour + k * block_size);
    }
};

/// The share of ground and walls in a particle's density.
struct BoundaryShare {
    L density;
    V3 gradient;
};

HWY_INLINE Mask near_walls(const Ground& ground, const V3& p) {
    Mask near;
    if (ground.solids.empty()) return near;
    for (int lane = 0; lane < lane_count; ++lane) {
        near.bits[lane] = ground.solids.near(p.x.at(lane), p.y.at(lane)) ? -1 : 0;
    }
    return near;
}

/// Samples ground and walls for particles at `p`, which is `displacement` from their position at the step's start.
HWY_INLINE BoundaryShare sample_boundary_at(const Model& model, const Ground& ground, const State& state, Work& work,
                                            std::size_t i, const V3& p, const V3& displacement) {
    const GroundFace<L> base = sample_ground(model, ground.terrain, p);
    BoundaryShare share{base.density, base.normal * base.slope};
    store(base.distance - dot(displacement, base.normal), work.ground_distance, i);
    store(base.slope, work.ground_slope, i);
    store(base.normal, work.ground_normal, i);
    store(share.gradient, work.boundary_gradient, i);
    if (ground.solids.empty()) return share;
    const Mask near = near_walls(ground, p);
    std::fill_n(work.has_walls.begin() + static_cast<std::ptrdiff_t>(i), lane_count, 0);
    if (!any(near)) return share;
    for (int lane = 0; lane < lane_count; ++lane) {
        if (!near.at(lane)) continue;
        share.density.set(lane,
                          sample_walls(model, ground, state, work, i + static_cast<std::size_t>(lane),
                                       {p.x.at(lane), p.y.at(lane), p.z.at(lane)},
                                       {displacement.x.at(lane), displacement.y.at(lane), displacement.z.at(lane)}));
    }
    share.gradient = load(work.boundary_gradient, i);
    return share;
}

}  // namespace talus::sim::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
