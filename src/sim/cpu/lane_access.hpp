#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/cpu/neighbours.hpp"
#include "sim/state.hpp"
#include "simd/lanes.hpp"

/// How lanes are loaded from the arrays of particles and stored to them.
namespace talus::sim::cpu {

/// Loads and stores of `count` numbers next to each other.
template <int count>
struct LaneAccess {
    using Real = simd::Lanes<count>;
    using Vector = Vec3<Real>;
    using Mask = simd::LaneMask<count>;

    TALUS_INLINE static Real load(const std::vector<float>& from, std::size_t i) { return Real::load(from.data() + i); }
    TALUS_INLINE static Vector load(const VectorArray& from, std::size_t i) {
        return {load(from.x, i), load(from.y, i), load(from.z, i)};
    }
    TALUS_INLINE static Deviator<Real> load(const DeviatorArray& from, std::size_t i) {
        return {load(from.xx, i), load(from.yy, i), load(from.xy, i), load(from.xz, i), load(from.yz, i)};
    }
    TALUS_INLINE static void store(const Real& numbers, std::vector<float>& to, std::size_t i) {
        numbers.store(to.data() + i);
    }
    TALUS_INLINE static void store(const Vector& v, VectorArray& to, std::size_t i) {
        store(v.x, to.x, i);
        store(v.y, to.y, i);
        store(v.z, to.z, i);
    }
    TALUS_INLINE static void store(const Deviator<Real>& s, DeviatorArray& to, std::size_t i) {
        store(s.xx, to.xx, i);
        store(s.yy, to.yy, i);
        store(s.xy, to.xy, i);
        store(s.xz, to.xz, i);
        store(s.yz, to.yz, i);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE static Octs<Real> load(const std::vector<Row>& from, std::size_t i) {
        return simd::load_octs<count>(from.data() + i);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE static Quads<Real> load_low(const std::vector<Row>& from, std::size_t i) {
        return simd::load_quads<count, 0>(from.data() + i);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE static Quads<Real> load_high(const std::vector<Row>& from, std::size_t i) {
        return simd::load_quads<count, 1>(from.data() + i);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE static void store_low(const Quads<Real>& quads, std::vector<Row>& to, std::size_t i) {
        simd::store_quads<count, 0>(quads, to.data() + i);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE static void store_high(const Quads<Real>& quads, std::vector<Row>& to, std::size_t i) {
        simd::store_quads<count, 1>(quads, to.data() + i);
    }
    /// A vector and a fourth number.
    TALUS_INLINE static Quads<Real> with(const Vector& v, const Real& w) { return {v.x, v.y, v.z, w}; }
    TALUS_INLINE static Vector vector_of(const Quads<Real>& quads) { return {quads.x, quads.y, quads.z}; }
    /// `set` or `clear`, as the flags of the particles say.
    TALUS_INLINE static Real flags(const std::vector<std::uint8_t>& from, std::size_t i, float set, float clear) {
        Real result(clear);
        for (int lane = 0; lane < count; ++lane) {
            if (from[i + static_cast<std::size_t>(lane)]) result.set(lane, set);
        }
        return result;
    }
    TALUS_INLINE static LocalPoint at(const Vector& v, int lane) { return {v.x.at(lane), v.y.at(lane), v.z.at(lane)}; }
    TALUS_INLINE static void set(Vector& v, int lane, const LocalPoint& to) {
        v.x.set(lane, to.x);
        v.y.set(lane, to.y);
        v.z.set(lane, to.z);
    }
};

/// The neighbours of `count` particles, side by side.
template <int count>
struct LaneLists : LaneAccess<count> {
    using Access = LaneAccess<count>;
    using typename Access::Mask, typename Access::Real, typename Access::Vector;

    const std::uint32_t* neighbour;
    float *gradient_x, *gradient_y, *gradient_z;
    std::uint32_t length;
    Real entries;  ///< in the list of each

    TALUS_INLINE LaneLists(NeighbourLists& lists, std::size_t i)
        : length(lists.length[i / block_size]), entries(Access::load(lists.count, i)) {
        const std::size_t at = lists.start[i / block_size] + i % block_size;
        neighbour = lists.neighbour.data() + at;
        gradient_x = lists.gradient.x.data() + at;
        gradient_y = lists.gradient.y.data() + at;
        gradient_z = lists.gradient.z.data() + at;
    }
    /// Lanes whose entry is `first` or a later particle.
    TALUS_INLINE Mask from_on(std::uint32_t k, std::uint32_t first) const {
        typename Mask::Ints entry;
        __builtin_memcpy(&entry, neighbour + k * block_size, sizeof entry);
        return Mask(typename Mask::Ints(entry >= static_cast<std::int32_t>(first)));
    }
    TALUS_INLINE Vector gradient(std::uint32_t k) const {
        const std::size_t at = k * block_size;
        return {Real::load(gradient_x + at), Real::load(gradient_y + at), Real::load(gradient_z + at)};
    }
    TALUS_INLINE void keep(std::uint32_t k, const Vector& gradient) const {
        const std::size_t at = k * block_size;
        gradient.x.store(gradient_x + at);
        gradient.y.store(gradient_y + at);
        gradient.z.store(gradient_z + at);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE Octs<Real> gather(const std::vector<Row>& from, std::uint32_t k) const {
        return simd::octs_at<count>(from.data(), neighbour + k * block_size);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE Quads<Real> gather_low(const std::vector<Row>& from, std::uint32_t k) const {
        return simd::quads_at<count, 0>(from.data(), neighbour + k * block_size);
    }
    template <std::derived_from<simd::Oct> Row>
    TALUS_INLINE Quads<Real> gather_high(const std::vector<Row>& from, std::uint32_t k) const {
        return simd::quads_at<count, 1>(from.data(), neighbour + k * block_size);
    }
};

}  // namespace talus::sim::cpu
