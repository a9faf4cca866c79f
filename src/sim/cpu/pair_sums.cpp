// Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/pair_sums.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <array>
#include <hwy/highway.h>

#include "sim/cpu/pair_kernels-inl.hpp"
#include "sim/cpu/pair_sums.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
constexpr D d;

HWY_INLINE float sum(V v) {
    return hn::GetLane(hn::SumOfLanes(d, v));
}

/// Four vectors: the packed numbers of as many neighbours as there are lanes.
struct V4 {
    V x, y, z, w;
};

#if HWY_TARGET == HWY_AVX2 || HWY_TARGET <= HWY_AVX3
/// Transposes 4 x 4 numbers within every block of 128 bits.
HWY_INLINE V4 transposed(V r0, V r1, V r2, V r3) {
    const V xy01 = hn::InterleaveLower(d, r0, r1), zw01 = hn::InterleaveUpper(d, r0, r1);
    const V xy23 = hn::InterleaveLower(d, r2, r3), zw23 = hn::InterleaveUpper(d, r2, r3);
    const hn::Repartition<double, D> pairs;
    const auto low = [&](V a, V b) {
        return hn::BitCast(d, hn::InterleaveLower(pairs, hn::BitCast(pairs, a), hn::BitCast(pairs, b)));
    };
    const auto high = [&](V a, V b) {
        return hn::BitCast(d, hn::InterleaveUpper(pairs, hn::BitCast(pairs, a), hn::BitCast(pairs, b)));
    };
    return {low(xy01, xy23), high(xy01, xy23), low(zw01, zw23), high(zw01, zw23)};
}

/// A load of 16 bytes per neighbour and a transposition: a gather instruction per number costs several times as much
/// (measured on Zen 4: 2.6 times over the whole step).
HWY_INLINE V4 gather(const Packed& from, const std::uint32_t* j) {
    const auto row = [&](std::size_t lane) { return _mm_loadu_ps(from[j[lane]].data()); };
    const auto rows = [&](std::size_t first) {
#if HWY_TARGET == HWY_AVX2
        return V{_mm256_insertf128_ps(_mm256_castps128_ps256(row(first)), row(first + 4), 1)};
#else
        __m512 four = _mm512_castps128_ps512(row(first));
        four = _mm512_insertf32x4(four, row(first + 4), 1);
        four = _mm512_insertf32x4(four, row(first + 8), 2);
        return V{_mm512_insertf32x4(four, row(first + 12), 3)};
#endif
    };
    return transposed(rows(0), rows(1), rows(2), rows(3));
}
#else
HWY_INLINE V4 gather(const Packed& from, const std::uint32_t* j) {
    HWY_ALIGN float x[hn::MaxLanes(d)], y[hn::MaxLanes(d)], z[hn::MaxLanes(d)], w[hn::MaxLanes(d)];
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
        const std::array<float, 4>& row = from[j[lane]];
        x[lane] = row[0];
        y[lane] = row[1];
        z[lane] = row[2];
        w[lane] = row[3];
    }
    return {hn::Load(d, x), hn::Load(d, y), hn::Load(d, z), hn::Load(d, w)};
}
#endif

/// Three vectors: a coordinate each.
struct V3 {
    V x, y, z;

    explicit V3(const std::array<float, 4>& p) : x(hn::Set(d, p[0])), y(hn::Set(d, p[1])), z(hn::Set(d, p[2])) {}
    explicit V3(const V4& v) : x(v.x), y(v.y), z(v.z) {}
    V3(V x_, V y_, V z_) : x(x_), y(y_), z(z_) {}
    static V3 zero() { return V3(hn::Zero(d), hn::Zero(d), hn::Zero(d)); }
    V3 minus(const V3& o) const { return V3(hn::Sub(x, o.x), hn::Sub(y, o.y), hn::Sub(z, o.z)); }
    V3 times(V s) const { return V3(hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s)); }
    V dot(const V3& o) const { return hn::MulAdd(z, o.z, hn::MulAdd(y, o.y, hn::Mul(x, o.x))); }
    /// this += s v
    void add(V s, const V3& v) {
        x = hn::MulAdd(s, v.x, x);
        y = hn::MulAdd(s, v.y, y);
        z = hn::MulAdd(s, v.z, z);
    }
    Vec3<float> total() const { return {sum(x), sum(y), sum(z)}; }
};

/// Calls f(k) for every vector of a padded list of neighbours.
template <class F>
HWY_INLINE void for_each_vector(const PairList& pairs, const F& f) {
    for (std::size_t k = 0; k < pairs.count; k += hn::Lanes(d)) f(k);
}

HWY_INLINE V quotient(const PairScale& scale, V square) {
    return hn::Min(hn::Set(d, 1.0f), hn::Mul(hn::Sqrt(square), hn::Set(d, scale.inverse_radius)));
}

template <class Kernel, bool all>
DensitySums density_sums(const PairScale& scale, const PairList& pairs, const Packed& points,
                         const Packed* displacements, std::size_t i) {
    const V3 p(points[i]), moved(all ? (*displacements)[i] : points[i]);
    V density = hn::Zero(d), squares = hn::Zero(d), divergence = hn::Zero(d);
    V3 gradient = V3::zero();
    for_each_vector(pairs, [&](std::size_t k) {
        const V3 separation = p.minus(V3(gather(points, pairs.neighbour + k)));
        const V square = separation.dot(separation);
        const V q = quotient(scale, square);
        density = hn::Add(density, hn::IfThenElseZero(hn::FirstN(d, pairs.count - k), Kernel::value(d, q)));
        const V slope = hn::Mul(Kernel::slope_over_q(d, q), hn::Set(d, -scale.gradient_scale));
        const V3 pair_gradient = separation.times(slope);
        hn::StoreU(pair_gradient.x, d, pairs.gradient_x + k);
        hn::StoreU(pair_gradient.y, d, pairs.gradient_y + k);
        hn::StoreU(pair_gradient.z, d, pairs.gradient_z + k);
        if constexpr (all) {
            squares = hn::MulAdd(hn::Mul(slope, slope), square, squares);
            gradient.add(hn::Set(d, 1.0f), pair_gradient);
            const V3 difference = V3(gather(*displacements, pairs.neighbour + k)).minus(moved);
            divergence = hn::Add(divergence, difference.dot(pair_gradient));
        }
    });
    DensitySums result;
    result.density = scale.value_scale * (sum(density) + Kernel::value_at_zero());
    if constexpr (all) {
        result.square = sum(squares);
        result.gradient = gradient.total();
        result.divergence = sum(divergence);
    }
    return result;
}

template <class Kernel>
DensitySums density(const PairScale& scale, const PairList& pairs, const Packed& points, std::size_t i) {
    return density_sums<Kernel, false>(scale, pairs, points, nullptr, i);
}

template <class Kernel>
DensitySums density_and_divergence(const PairScale& scale, const PairList& pairs, const Packed& points,
                                   const Packed& displacements, std::size_t i) {
    return density_sums<Kernel, true>(scale, pairs, points, &displacements, i);
}

/// The pair gradients that density_sums() has left in a list.
HWY_INLINE V3 kept_gradient(const PairList& pairs, std::size_t k) {
    return V3(hn::LoadU(d, pairs.gradient_x + k), hn::LoadU(d, pairs.gradient_y + k),
              hn::LoadU(d, pairs.gradient_z + k));
}

DisplacementGradient<float> deformation(const PairList& pairs, const Packed& displacements, std::size_t i) {
    const V3 moved(displacements[i]);
    V3 x = V3::zero(), y = V3::zero(), z = V3::zero();
    for_each_vector(pairs, [&](std::size_t k) {
        const V3 gradient = kept_gradient(pairs, k);
        const V3 difference = V3(gather(displacements, pairs.neighbour + k)).minus(moved);
        x.add(difference.x, gradient);
        y.add(difference.y, gradient);
        z.add(difference.z, gradient);
    });
    return {x.total(), y.total(), z.total()};
}

Vec3<float> stress_correction(const PairList& pairs, const Packed& stress_rows, const Packed& stress_rest,
                              std::size_t i) {
    const auto& own = stress_rows[i];
    const auto& own_rest = stress_rest[i];
    const V own_xx = hn::Set(d, own[0]), own_xy = hn::Set(d, own[1]), own_xz = hn::Set(d, own[2]);
    const V own_yy = hn::Set(d, own[3]), own_yz = hn::Set(d, own_rest[0]), own_zz = hn::Set(d, own_rest[1]);
    V3 correction = V3::zero();
    for_each_vector(pairs, [&](std::size_t k) {
        const V3 gradient = kept_gradient(pairs, k);
        const V4 rows = gather(stress_rows, pairs.neighbour + k), rest = gather(stress_rest, pairs.neighbour + k);
        const V xy = hn::Add(own_xy, rows.y), xz = hn::Add(own_xz, rows.z), yz = hn::Add(own_yz, rest.x);
        correction.add(gradient.x, V3(hn::Add(own_xx, rows.x), xy, xz));
        correction.add(gradient.y, V3(xy, hn::Add(own_yy, rows.w), yz));
        correction.add(gradient.z, V3(xz, yz, hn::Add(own_zz, rest.y)));
    });
    return correction.total();
}

Vec3<float> scalar_correction(const PairList& pairs, const Packed& scalars, std::size_t i) {
    const V own = hn::Set(d, scalars[i][3]);
    V3 correction = V3::zero();
    for_each_vector(pairs, [&](std::size_t k) {
        correction.add(hn::Add(own, gather(scalars, pairs.neighbour + k).w), kept_gradient(pairs, k));
    });
    return correction.total();
}

template <class Kernel>
Vec3<float> pair_correction(const PairScale& scale, const PairList& pairs, const Packed& points,
                            const Packed& displacements, float cap, std::size_t i) {
    const V3 p(points[i]), moved(displacements[i]);
    const V own = hn::Set(d, points[i][3]), zero = hn::Zero(d);
    V3 correction = V3::zero();
    for_each_vector(pairs, [&](std::size_t k) {
        const V4 other = gather(points, pairs.neighbour + k);
        const V change = hn::Add(own, other.w);
        const V3 separation = p.minus(V3(other));
        const V square = separation.dot(separation);
        const V distance = hn::Sqrt(square);
        const V q = hn::Min(hn::Set(d, 1.0f), hn::Mul(distance, hn::Set(d, scale.inverse_radius)));
        const V push = hn::Mul(hn::Mul(change, hn::Set(d, -scale.gradient_scale)), Kernel::slope_over_q(d, q));
        correction.add(push, separation);

        // Friction as in pair_friction(): against the tangential displacement, at most half of it by weight, at most
        // the cap times the normal correction, and none between particles that part.
        const V3 relative = moved.minus(V3(gather(displacements, pairs.neighbour + k)));
        const V along = hn::Div(relative.dot(separation), hn::Add(square, hn::Set(d, 1e-12f)));
        V3 tangential = relative;
        tangential.add(hn::Neg(along), separation);
        const V size = hn::Sqrt(tangential.dot(tangential));
        const V limit = hn::Mul(hn::Max(zero, hn::Mul(push, distance)), hn::Set(d, cap));
        const V weight = hn::Mul(Kernel::value(d, q), hn::Set(d, 0.5f * scale.value_scale));
        const V share = hn::Min(weight, hn::Div(limit, hn::Max(size, hn::Set(d, 1e-30f))));
        correction.add(hn::Neg(share), tangential);
    });
    return correction.total();
}

template <class Kernel>
Vec3<float> velocity_difference(const PairScale& scale, const PairList& pairs, const Packed& points,
                                const Packed& velocities, std::size_t i) {
    const V3 p(points[i]), own(velocities[i]);
    V3 difference = V3::zero();
    for_each_vector(pairs, [&](std::size_t k) {
        const V3 separation = p.minus(V3(gather(points, pairs.neighbour + k)));
        const V q = quotient(scale, separation.dot(separation));
        const V weight = hn::Mul(Kernel::value(d, q), hn::Set(d, scale.value_scale));
        difference.add(weight, V3(gather(velocities, pairs.neighbour + k)).minus(own));
    });
    return difference.total();
}

std::size_t select_near(const Coordinates& points, std::uint32_t first, std::uint32_t last, const Vec3<float>& p,
                        float square_radius, std::uint32_t* found) {
    const hn::RebindToUnsigned<D> du;
    const std::size_t lanes = hn::Lanes(d);
    const V px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z);
    const V limit = hn::Set(d, square_radius);
    std::size_t count = 0;
    for (std::uint32_t j = first; j < last; j += static_cast<std::uint32_t>(lanes)) {
        const V dx = hn::Sub(hn::LoadU(d, points.x + j), px), dy = hn::Sub(hn::LoadU(d, points.y + j), py);
        const V dz = hn::Sub(hn::LoadU(d, points.z + j), pz);
        const V square = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
        const auto near = hn::And(hn::Lt(square, limit), hn::FirstN(d, last - j));
        // In a register and then stored whole: the instruction that compresses into memory is slow on AMD.
        const auto selected = hn::RebindMask(du, near);
        hn::StoreU(hn::Compress(hn::Iota(du, j), selected), du, found + count);
        count += hn::CountTrue(du, selected);
    }
    return count;
}

template <class Kernel>
PairSums table_of() {
    return {density<Kernel>,
            density_and_divergence<Kernel>,
            deformation,
            stress_correction,
            scalar_correction,
            pair_correction<Kernel>,
            velocity_difference<Kernel>,
            select_near,
            hwy::TargetName(HWY_TARGET)};
}

PairSums make_table(KernelChoice kernel) {
    switch (kernel) {
        case KernelChoice::cubic_spline:
            return table_of<CubicSpline>();
        case KernelChoice::spiky:
            return table_of<Spiky>();
        case KernelChoice::poly6_spiky:
            return table_of<Poly6Spiky>();
        case KernelChoice::wendland_c2:
            break;
    }
    return table_of<WendlandC2>();
}

}  // namespace talus::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cstdlib>

namespace talus::cpu {

HWY_EXPORT(make_table);

PairSums pair_sums_for(KernelChoice kernel) {
    if (const char* wanted = std::getenv("TALUS_SIMD")) {
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
            if (std::string_view(wanted) == hwy::TargetName(target)) {
                hwy::SetSupportedTargetsForTest(target);
                const PairSums sums = HWY_DYNAMIC_DISPATCH(make_table)(kernel);
                hwy::SetSupportedTargetsForTest(0);
                return sums;
            }
        }
    }
    return HWY_DYNAMIC_DISPATCH(make_table)(kernel);
}

}  // namespace talus::cpu
#endif
