#pragma once

#include <type_traits>

#include "core/number.hpp"
#include "simd/lanes.hpp"

/// Two registers of lanes as one number. Long formulas wait for their divisions and square roots: with two of them at
/// once, operation by operation, a processor does the one while the other waits.
namespace talus::simd {

template <int half>
struct PairMask {
    LaneMask<half> a, b;

    PairMask() = default;
    TALUS_INLINE PairMask(const LaneMask<half>& first, const LaneMask<half>& second) : a(first), b(second) {}

    TALUS_INLINE friend PairMask operator&(const PairMask& x, const PairMask& y) { return {x.a & y.a, x.b & y.b}; }
    TALUS_INLINE friend PairMask operator|(const PairMask& x, const PairMask& y) { return {x.a | y.a, x.b | y.b}; }
    TALUS_INLINE friend PairMask operator!(const PairMask& x) { return {!x.a, !x.b}; }
    TALUS_INLINE friend bool any(const PairMask& x) { return any(x.a | x.b); }
};

/// Twice `half` floats.
template <int half>
struct LanePair {
    using Half = Lanes<half>;
    static constexpr int size = 2 * half;
    Half a, b;

    LanePair() = default;
    TALUS_INLINE LanePair(const Half& first, const Half& second) : a(first), b(second) {}
    template <class Number>
    requires std::is_arithmetic_v<Number> TALUS_INLINE LanePair(Number number) : a(number), b(number) {}

    TALUS_INLINE static LanePair load(const float* from) { return {Half::load(from), Half::load(from + half)}; }
    TALUS_INLINE void store(float* to) const {
        a.store(to);
        b.store(to + half);
    }
    [[nodiscard]] float at(int lane) const { return lane < half ? a.at(lane) : b.at(lane - half); }

    TALUS_INLINE friend LanePair operator+(const LanePair& x, const LanePair& y) { return {x.a + y.a, x.b + y.b}; }
    TALUS_INLINE friend LanePair operator-(const LanePair& x, const LanePair& y) { return {x.a - y.a, x.b - y.b}; }
    TALUS_INLINE friend LanePair operator*(const LanePair& x, const LanePair& y) { return {x.a * y.a, x.b * y.b}; }
    TALUS_INLINE friend LanePair operator/(const LanePair& x, const LanePair& y) { return {x.a / y.a, x.b / y.b}; }
    TALUS_INLINE friend LanePair operator-(const LanePair& x) { return {-x.a, -x.b}; }

    TALUS_INLINE friend PairMask<half> operator<(const LanePair& x, const LanePair& y) {
        return {x.a < y.a, x.b < y.b};
    }
    TALUS_INLINE friend PairMask<half> operator>(const LanePair& x, const LanePair& y) {
        return {x.a > y.a, x.b > y.b};
    }
    TALUS_INLINE friend PairMask<half> operator<=(const LanePair& x, const LanePair& y) {
        return {x.a <= y.a, x.b <= y.b};
    }
    TALUS_INLINE friend PairMask<half> operator>=(const LanePair& x, const LanePair& y) {
        return {x.a >= y.a, x.b >= y.b};
    }
    TALUS_INLINE friend PairMask<half> operator==(const LanePair& x, const LanePair& y) {
        return {x.a == y.a, x.b == y.b};
    }
    TALUS_INLINE friend LanePair select(const PairMask<half>& mask, const LanePair& yes, const LanePair& no) {
        return {select(mask.a, yes.a, no.a), select(mask.b, yes.b, no.b)};
    }
    TALUS_INLINE friend LanePair sqrt(const LanePair& x) { return {sqrt(x.a), sqrt(x.b)}; }
    TALUS_INLINE friend LanePair opaque(const LanePair& x) { return {opaque(x.a), opaque(x.b)}; }
};

}  // namespace talus::simd
