// Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/cpu/pair_sums.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <cstring>
#include <hwy/highway.h>

#include "sim/cpu/pair_kernels-inl.hpp"
#include "sim/cpu/pair_sums.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using Indices = hn::Vec<hn::RebindToSigned<D>>;
constexpr D d;
constexpr hn::RebindToSigned<D> di;

float sum(V v) {
    return hn::GetLane(hn::SumOfLanes(d, v));
}

/// Three vectors: a coordinate each.
struct V3 {
    V x, y, z;

    explicit V3(const Vec3<float>& p) : x(hn::Set(d, p.x)), y(hn::Set(d, p.y)), z(hn::Set(d, p.z)) {}
    V3(V x_, V y_, V z_) : x(x_), y(y_), z(z_) {}
    static V3 zero() { return V3(hn::Zero(d), hn::Zero(d), hn::Zero(d)); }
    static V3 gather(const Coordinates& from, Indices j) {
        return V3(hn::GatherIndex(d, from.x, j), hn::GatherIndex(d, from.y, j), hn::GatherIndex(d, from.z, j));
    }
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

// Masked loads and stores touch memory beyond the mask on some instruction sets; part of a vector goes through a copy.
V load_part(const float* from, std::size_t count) {
    HWY_ALIGN float part[hn::MaxLanes(d)] = {};
    std::memcpy(part, from, count * sizeof(float));
    return hn::Load(d, part);
}

void store_part(V v, float* to, std::size_t count) {
    HWY_ALIGN float part[hn::MaxLanes(d)];
    hn::Store(v, d, part);
    std::memcpy(to, part, count * sizeof(float));
}

/// A vector of a particle's neighbours: all lanes, or the first `count` of the list's last vector. The other lanes have
/// index 0.
struct FullVector {
    std::size_t at;
    Indices j;

    V keep(V v) const { return v; }
    V load(const float* from) const { return hn::LoadU(d, from + at); }
    void store(V v, float* to) const { hn::StoreU(v, d, to + at); }
};

struct PartVector {
    std::size_t at, count;
    Indices j;

    /// v in the lanes that stand for a neighbour, 0 in the others.
    V keep(V v) const { return hn::IfThenElseZero(hn::FirstN(d, count), v); }
    V load(const float* from) const { return load_part(from + at, count); }
    void store(V v, float* to) const { store_part(v, to + at, count); }
};

/// Calls f with every vector of neighbours.
template <class F>
void for_each_vector(const PairList& pairs, const F& f) {
    const std::size_t lanes = hn::Lanes(d);
    const auto* index = reinterpret_cast<const std::int32_t*>(pairs.neighbour);
    std::size_t k = 0;
    for (; k + lanes <= pairs.count; k += lanes) f(FullVector{k, hn::LoadU(di, index + k)});
    if (k == pairs.count) return;
    HWY_ALIGN std::int32_t part[hn::MaxLanes(d)] = {};
    std::memcpy(part, index + k, (pairs.count - k) * sizeof(std::int32_t));
    f(PartVector{k, pairs.count - k, hn::Load(di, part)});
}

V quotient(const PairScale& scale, V square) {
    return hn::Min(hn::Set(d, 1.0f), hn::Mul(hn::Sqrt(square), hn::Set(d, scale.inverse_radius)));
}

template <class Kernel, bool deforms>
DensitySums density_sums(const PairScale& scale, const PairList& pairs, const Coordinates& points,
                         const Coordinates* displacements, std::size_t i) {
    const V3 p(points.at(i));
    const V3 moved(deforms ? displacements->at(i) : Vec3<float>{});
    V density = hn::Zero(d), squares = hn::Zero(d);
    V3 gradient = V3::zero(), deformation_x = V3::zero(), deformation_y = V3::zero(), deformation_z = V3::zero();
    for_each_vector(pairs, [&](const auto& part) {
        const V3 separation = p.minus(V3::gather(points, part.j));
        const V square = separation.dot(separation);
        const V q = quotient(scale, square);
        density = hn::Add(density, part.keep(Kernel::value(d, q)));
        const V slope = part.keep(hn::Mul(Kernel::slope_over_q(d, q), hn::Set(d, -scale.gradient_scale)));
        const V3 pair_gradient = separation.times(slope);
        part.store(pair_gradient.x, pairs.gradient_x);
        part.store(pair_gradient.y, pairs.gradient_y);
        part.store(pair_gradient.z, pairs.gradient_z);
        if constexpr (deforms) {
            squares = hn::MulAdd(hn::Mul(slope, slope), square, squares);
            gradient.add(hn::Set(d, 1.0f), pair_gradient);
            const V3 difference = V3::gather(*displacements, part.j).minus(moved);
            deformation_x.add(difference.x, pair_gradient);
            deformation_y.add(difference.y, pair_gradient);
            deformation_z.add(difference.z, pair_gradient);
        }
    });
    DensitySums result;
    result.density = scale.value_scale * (sum(density) + Kernel::value_at_zero());
    if constexpr (deforms) {
        result.square = sum(squares);
        result.gradient = gradient.total();
        result.deformation = {deformation_x.total(), deformation_y.total(), deformation_z.total()};
    }
    return result;
}

template <class Kernel>
DensitySums density(const PairScale& scale, const PairList& pairs, const Coordinates& points, std::size_t i) {
    return density_sums<Kernel, false>(scale, pairs, points, nullptr, i);
}

template <class Kernel>
DensitySums density_and_deformation(const PairScale& scale, const PairList& pairs, const Coordinates& points,
                                    const Coordinates& displacements, std::size_t i) {
    return density_sums<Kernel, true>(scale, pairs, points, &displacements, i);
}

Vec3<float> stress_correction(const PairList& pairs, const float* multiplier_change, const Deviators& stress_change,
                              std::size_t i) {
    const Deviators& s = stress_change;
    const V own = hn::Set(d, multiplier_change[i]);
    const V own_xx = hn::Set(d, s.xx[i]), own_yy = hn::Set(d, s.yy[i]);
    const V own_xy = hn::Set(d, s.xy[i]), own_xz = hn::Set(d, s.xz[i]), own_yz = hn::Set(d, s.yz[i]);
    V3 correction = V3::zero();
    for_each_vector(pairs, [&](const auto& part) {
        const Indices j = part.j;
        const V gx = part.load(pairs.gradient_x), gy = part.load(pairs.gradient_y), gz = part.load(pairs.gradient_z);
        const V pressure = hn::Add(own, hn::GatherIndex(d, multiplier_change, j));
        const V xx = hn::Add(own_xx, hn::GatherIndex(d, s.xx, j));
        const V yy = hn::Add(own_yy, hn::GatherIndex(d, s.yy, j));
        const V xy = hn::Add(own_xy, hn::GatherIndex(d, s.xy, j));
        const V xz = hn::Add(own_xz, hn::GatherIndex(d, s.xz, j));
        const V yz = hn::Add(own_yz, hn::GatherIndex(d, s.yz, j));
        const V zz = hn::Sub(pressure, hn::Add(xx, yy));
        correction.add(gx, V3(hn::Add(pressure, xx), xy, xz));
        correction.add(gy, V3(xy, hn::Add(pressure, yy), yz));
        correction.add(gz, V3(xz, yz, zz));
    });
    return correction.total();
}

template <class Kernel>
Vec3<float> pair_correction(const PairScale& scale, const PairList& pairs, const Coordinates& points,
                            const Coordinates& displacements, const float* multiplier_change, float cap,
                            std::size_t i) {
    const V3 p(points.at(i)), moved(displacements.at(i));
    const V own = hn::Set(d, multiplier_change[i]), zero = hn::Zero(d);
    V3 correction = V3::zero();
    for_each_vector(pairs, [&](const auto& part) {
        const V change = part.keep(hn::Add(own, hn::GatherIndex(d, multiplier_change, part.j)));
        const V3 separation = p.minus(V3::gather(points, part.j));
        const V square = separation.dot(separation);
        const V distance = hn::Sqrt(square);
        const V q = hn::Min(hn::Set(d, 1.0f), hn::Mul(distance, hn::Set(d, scale.inverse_radius)));
        const V push = hn::Mul(hn::Mul(change, hn::Set(d, -scale.gradient_scale)), Kernel::slope_over_q(d, q));
        correction.add(push, separation);

        // Friction as in pair_friction(): against the tangential displacement, at most half of it by weight, at most
        // the cap times the normal correction, and none between particles that part.
        const V3 relative = moved.minus(V3::gather(displacements, part.j));
        const V along = hn::Div(relative.dot(separation), hn::Add(square, hn::Set(d, 1e-12f)));
        V3 tangential = relative;
        tangential.add(hn::Neg(along), separation);
        const V size = hn::Sqrt(tangential.dot(tangential));
        const V limit = hn::Mul(hn::Max(zero, hn::Mul(push, distance)), hn::Set(d, cap));
        const V weight = hn::Mul(Kernel::value(d, q), hn::Set(d, 0.5f * scale.value_scale));
        const V share = hn::Min(weight, hn::Div(limit, hn::Max(size, hn::Set(d, 1e-30f))));
        correction.add(hn::Neg(part.keep(share)), tangential);
    });
    return correction.total();
}

template <class Kernel>
Vec3<float> velocity_difference(const PairScale& scale, const PairList& pairs, const Coordinates& points,
                                const Coordinates& velocities, std::size_t i) {
    const V3 p(points.at(i)), own(velocities.at(i));
    V3 difference = V3::zero();
    for_each_vector(pairs, [&](const auto& part) {
        const V3 separation = p.minus(V3::gather(points, part.j));
        const V q = quotient(scale, separation.dot(separation));
        const V weight = part.keep(hn::Mul(Kernel::value(d, q), hn::Set(d, scale.value_scale)));
        difference.add(weight, V3::gather(velocities, part.j).minus(own));
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
    const auto select = [&](std::uint32_t j, V x, V y, V z, auto near_of) {
        const V dx = hn::Sub(x, px), dy = hn::Sub(y, py), dz = hn::Sub(z, pz);
        const V square = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
        const auto near = near_of(hn::Lt(square, limit));
        count += hn::CompressStore(hn::Iota(du, j), hn::RebindMask(du, near), du, found + count);
    };
    std::uint32_t j = first;
    for (; j + lanes <= last; j += static_cast<std::uint32_t>(lanes)) {
        select(j, hn::LoadU(d, points.x + j), hn::LoadU(d, points.y + j), hn::LoadU(d, points.z + j),
               [](auto mask) { return mask; });
    }
    if (j < last) {
        const std::size_t rest = last - j;
        select(j, load_part(points.x + j, rest), load_part(points.y + j, rest), load_part(points.z + j, rest),
               [&](auto mask) { return hn::And(mask, hn::FirstN(d, rest)); });
    }
    return count;
}

template <class Kernel>
PairSums table_of() {
    return {density<Kernel>,
            density_and_deformation<Kernel>,
            stress_correction,
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
