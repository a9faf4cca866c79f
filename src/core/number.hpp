#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

/// The functions with which a formula runs on one number or on many in parallel (simd/lanes.hpp): `select` in place of
/// a branch; the rest is ordinary code. These are the versions for one number.
namespace talus {

/// For small functions, and for those that pass bare vectors: these are passed in other registers where a wider
/// instruction set is enabled, so that a call between the two would be wrong. Lanes and masks are safe because they
/// have copy constructors: they are passed in memory.
///
/// TALUS_DEVICE marks what also runs on a graphics card (sim/device); it is empty where no compiler for one reads it.
/// TALUS_INLINE includes it.
#if defined(__CUDACC__)
#define TALUS_DEVICE __host__ __device__
#define TALUS_INLINE __host__ __device__ __forceinline__
#else
#define TALUS_DEVICE
#define TALUS_INLINE [[gnu::always_inline]] inline
#endif

/// Four adjacent numbers: a gather of all four is one load.
struct Quad {
    std::array<float, 4> v{};

    [[nodiscard]] TALUS_DEVICE const float* data() const { return v.data(); }
    TALUS_DEVICE float operator[](std::size_t i) const { return v[i]; }
    TALUS_DEVICE float& operator[](std::size_t i) { return v[i]; }
};

/// The numbers of a Quad, of one particle or of many.
template <class Real>
struct Quads {
    Real x{}, y{}, z{}, w{};
};
/// Twice four numbers.
template <class Real>
struct Octs {
    Quads<Real> low, high;
};

template <std::floating_point Real>
TALUS_DEVICE Real select(bool condition, Real yes, Real no) {
    return condition ? yes : no;
}
TALUS_DEVICE inline bool any(bool condition) {
    return condition;
}
/// The same number, of which the compiler knows nothing. Where conditions meet: it takes combined ones, and nested
/// choices between the same values, apart lane by lane where AVX-512 has one bit per lane (GCC 12).
template <std::floating_point Real>
TALUS_DEVICE Real opaque(Real a) {
    return a;
}
/// Towards zero; for values that fit an int.
template <std::floating_point Real>
TALUS_DEVICE std::int32_t truncated(Real a) {
    return static_cast<std::int32_t>(a);
}
template <class Real, class Index>
TALUS_INLINE Real from_index(const Index& index) {
    if constexpr (std::is_floating_point_v<Real>) {
        return static_cast<Real>(index);
    } else {
        return Real::from(index);
    }
}

/// As std::max and std::min: the first argument where they are equal or unordered.
template <class Real>
TALUS_INLINE Real larger(const Real& a, const Real& b) {
    return select(a < b, b, a);
}
template <class Real>
TALUS_INLINE Real smaller(const Real& a, const Real& b) {
    return select(b < a, b, a);
}

/// rows[index].
TALUS_DEVICE inline Quads<float> quads_at(const Quad* rows, std::int32_t index) {
    const Quad& row = rows[index];
    return {row[0], row[1], row[2], row[3]};
}
/// rows[index] and rows[index + 1].
TALUS_DEVICE inline Octs<float> quad_pairs_at(const Quad* rows, std::int32_t index) {
    return {quads_at(rows, index), quads_at(rows, index + 1)};
}

}  // namespace talus
