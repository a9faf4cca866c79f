#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "core/number.hpp"

/// Arithmetic with which a formula, written once, runs on one number or on as many as a vector register holds. A
/// formula uses `select` in place of a branch; the rest is ordinary code.
///
/// Built on the vector types of GCC and Clang, so a formula in any header compiles to the instruction set of the
/// function that it is inlined into. Nothing here fuses a multiplication and an addition: results are bit-identical on
/// every instruction set.
namespace talus::simd {

/// Twice four, in one cache line: a gather of all eight costs less than two of four.
struct alignas(32) Oct {
    std::array<float, 8> v{};
};

// A vector's size must not depend on a template parameter: GCC 12 then drops the attribute.
#define TALUS_SHUFFLES(...)                                                 \
    TALUS_INLINE static Floats shuffled(const Floats& a, const Floats& b) { \
        return __builtin_shufflevector(a, b, __VA_ARGS__);                  \
    }
using FourFloats = float __attribute__((vector_size(16)));
using EightFloats = float __attribute__((vector_size(32)));
using FourInts = std::int32_t __attribute__((vector_size(16)));
using EightInts = std::int32_t __attribute__((vector_size(32)));
using SixteenInts = std::int32_t __attribute__((vector_size(64)));
using TwoLongs = std::int64_t __attribute__((vector_size(16)));

TALUS_INLINE bool any_bit(const FourInts& bits) {
    TwoLongs halves;
    __builtin_memcpy(&halves, &bits, sizeof halves);
    return (halves[0] | halves[1]) != 0;
}
TALUS_INLINE bool any_bit(const EightInts& bits) {
    return any_bit(__builtin_shufflevector(bits, bits, 0, 1, 2, 3) | __builtin_shufflevector(bits, bits, 4, 5, 6, 7));
}

TALUS_INLINE bool any_bit(const SixteenInts& bits) {
    return any_bit(__builtin_shufflevector(bits, bits, 0, 1, 2, 3, 4, 5, 6, 7) |
                   __builtin_shufflevector(bits, bits, 8, 9, 10, 11, 12, 13, 14, 15));
}

template <int count>
struct LaneTypes;

template <>
struct LaneTypes<4> {
    using Floats = float __attribute__((vector_size(16)));
    using Ints = std::int32_t __attribute__((vector_size(16)));
    struct Low {
        TALUS_SHUFFLES(0, 4, 1, 5)
    };
    struct High {
        TALUS_SHUFFLES(2, 6, 3, 7)
    };
    struct LowPairs {
        TALUS_SHUFFLES(0, 1, 4, 5)
    };
    struct HighPairs {
        TALUS_SHUFFLES(2, 3, 6, 7)
    };
    /// The blocks of 128 bits that `block(0)`, `block(1)`, ... give, one after another.
    template <class Block>
    TALUS_INLINE static Floats joined(const Block& block) {
        return block(0);
    }
    template <class Take>
    TALUS_INLINE static void split(const Floats& v, const Take& take) {
        take(0, v);
    }
};

template <>
struct LaneTypes<8> {
    using Floats = float __attribute__((vector_size(32)));
    using Ints = std::int32_t __attribute__((vector_size(32)));
    struct Low {
        TALUS_SHUFFLES(0, 8, 1, 9, 4, 12, 5, 13)
    };
    struct High {
        TALUS_SHUFFLES(2, 10, 3, 11, 6, 14, 7, 15)
    };
    struct LowPairs {
        TALUS_SHUFFLES(0, 1, 8, 9, 4, 5, 12, 13)
    };
    struct HighPairs {
        TALUS_SHUFFLES(2, 3, 10, 11, 6, 7, 14, 15)
    };
    struct EvenBlocks {
        TALUS_SHUFFLES(0, 1, 2, 3, 8, 9, 10, 11)
    };
    struct OddBlocks {
        TALUS_SHUFFLES(4, 5, 6, 7, 12, 13, 14, 15)
    };
    template <class Block>
    TALUS_INLINE static Floats joined(const Block& block) {
        return __builtin_shufflevector(block(0), block(1), 0, 1, 2, 3, 4, 5, 6, 7);
    }
    template <class Take>
    TALUS_INLINE static void split(const Floats& v, const Take& take) {
        take(0, __builtin_shufflevector(v, v, 0, 1, 2, 3));
        take(1, __builtin_shufflevector(v, v, 4, 5, 6, 7));
    }
};

template <>
struct LaneTypes<16> {
    using Floats = float __attribute__((vector_size(64)));
    using Ints = std::int32_t __attribute__((vector_size(64)));
    struct Low {
        TALUS_SHUFFLES(0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29)
    };
    struct High {
        TALUS_SHUFFLES(2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31)
    };
    struct LowPairs {
        TALUS_SHUFFLES(0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29)
    };
    struct HighPairs {
        TALUS_SHUFFLES(2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31)
    };
    struct EvenBlocks {
        TALUS_SHUFFLES(0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27)
    };
    struct OddBlocks {
        TALUS_SHUFFLES(4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31)
    };
    template <class Block>
    TALUS_INLINE static Floats joined(const Block& block) {
        const EightFloats low = __builtin_shufflevector(block(0), block(1), 0, 1, 2, 3, 4, 5, 6, 7);
        const EightFloats high = __builtin_shufflevector(block(2), block(3), 0, 1, 2, 3, 4, 5, 6, 7);
        return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    }
    template <class Take>
    TALUS_INLINE static void split(const Floats& v, const Take& take) {
        take(0, __builtin_shufflevector(v, v, 0, 1, 2, 3));
        take(1, __builtin_shufflevector(v, v, 4, 5, 6, 7));
        take(2, __builtin_shufflevector(v, v, 8, 9, 10, 11));
        take(3, __builtin_shufflevector(v, v, 12, 13, 14, 15));
    }
};
#undef TALUS_SHUFFLES

/// The result of comparing lanes: all bits of a lane set, or none.
template <int count>
struct LaneMask {
    using Ints = typename LaneTypes<count>::Ints;
    Ints bits{};

    LaneMask() = default;
    TALUS_INLINE LaneMask(const Ints& all_bits) : bits(all_bits) {}
    TALUS_INLINE LaneMask(const LaneMask& o) : bits(o.bits) {}
    TALUS_INLINE LaneMask& operator=(const LaneMask& o) {
        bits = o.bits;
        return *this;
    }

    TALUS_INLINE friend LaneMask operator&(const LaneMask& a, const LaneMask& b) { return {a.bits & b.bits}; }
    TALUS_INLINE friend LaneMask operator|(const LaneMask& a, const LaneMask& b) { return {a.bits | b.bits}; }
    TALUS_INLINE friend LaneMask operator!(const LaneMask& a) { return {~a.bits}; }
    [[nodiscard]] bool at(int lane) const { return bits[lane] != 0; }
    TALUS_INLINE friend bool any(const LaneMask& a) {
#ifdef __wasm_simd128__
        return __builtin_wasm_any_true_v128(a.bits);
#else
        return any_bit(a.bits);  // halves: of a loop over the lanes GCC and Clang take each out of the register
#endif
    }
};

/// Whole numbers side by side, such as the indices of cells.
template <int count>
struct LaneInts {
    using Ints = typename LaneTypes<count>::Ints;
    Ints v{};

    LaneInts() = default;
    TALUS_INLINE LaneInts(const Ints& ints) : v(ints) {}
    TALUS_INLINE LaneInts(const LaneInts& o) : v(o.v) {}
    TALUS_INLINE LaneInts& operator=(const LaneInts& o) {
        v = o.v;
        return *this;
    }

    TALUS_INLINE friend LaneInts operator+(const LaneInts& a, const LaneInts& b) { return {a.v + b.v}; }
    TALUS_INLINE friend LaneInts operator*(const LaneInts& a, std::int32_t b) { return {a.v * b}; }
    TALUS_INLINE std::int32_t operator[](int lane) const { return v[lane]; }
};

/// `count` floats side by side. Not for arrays: GCC 12 fails over an array of vectors that the baseline lacks.
template <int count>
struct Lanes {
    using Floats = typename LaneTypes<count>::Floats;
    using Ints = typename LaneTypes<count>::Ints;
    static constexpr int size = count;
    Floats v{};

    Lanes() = default;
    TALUS_INLINE Lanes(const Floats& floats) : v(floats) {}
    TALUS_INLINE Lanes(const Lanes& o) : v(o.v) {}
    TALUS_INLINE Lanes& operator=(const Lanes& o) {
        v = o.v;
        return *this;
    }
    template <class Number>
    requires std::is_arithmetic_v<Number> TALUS_INLINE Lanes(Number number) {
        // In fours, which every baseline has: GCC splits a wider list of equal numbers into single elements.
        const FourFloats four = static_cast<float>(number) - FourFloats{};
        v = LaneTypes<count>::joined([&](int) __attribute__((always_inline)) { return four; });
    }

    TALUS_INLINE static Lanes load(const float* from) {
        Lanes result;
        __builtin_memcpy(&result.v, from, sizeof result.v);
        return result;
    }
    TALUS_INLINE void store(float* to) const { __builtin_memcpy(to, &v, sizeof v); }
    [[nodiscard]] float at(int lane) const { return v[lane]; }
    void set(int lane, float number) { v[lane] = number; }

    TALUS_INLINE friend Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(Floats(a.v + b.v)); }
    TALUS_INLINE friend Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(Floats(a.v - b.v)); }
    TALUS_INLINE friend Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(Floats(a.v * b.v)); }
    TALUS_INLINE friend Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(Floats(a.v / b.v)); }
    TALUS_INLINE friend Lanes operator-(const Lanes& a) { return Lanes(Floats(-a.v)); }
    TALUS_INLINE Lanes& operator+=(const Lanes& o) { return *this = *this + o; }
    TALUS_INLINE Lanes& operator*=(const Lanes& o) { return *this = *this * o; }

    TALUS_INLINE friend LaneMask<count> operator<(const Lanes& a, const Lanes& b) { return {a.v < b.v}; }
    TALUS_INLINE friend LaneMask<count> operator>(const Lanes& a, const Lanes& b) { return {a.v > b.v}; }
    TALUS_INLINE friend LaneMask<count> operator<=(const Lanes& a, const Lanes& b) { return {a.v <= b.v}; }
    TALUS_INLINE friend LaneMask<count> operator>=(const Lanes& a, const Lanes& b) { return {a.v >= b.v}; }
    TALUS_INLINE friend LaneMask<count> operator==(const Lanes& a, const Lanes& b) { return {a.v == b.v}; }
    TALUS_INLINE friend LaneMask<count> operator!=(const Lanes& a, const Lanes& b) { return {a.v != b.v}; }
    TALUS_INLINE friend Lanes select(const LaneMask<count>& mask, const Lanes& yes, const Lanes& no) {
        return Lanes(Floats(mask.bits ? yes.v : no.v));
    }
    TALUS_INLINE friend Lanes sqrt(const Lanes& a) {
#ifdef __wasm_simd128__
        return Lanes(Floats(__builtin_wasm_sqrt_f32x4(a.v)));
#else
        Lanes result;
        for (int lane = 0; lane < count; ++lane) result.v[lane] = __builtin_sqrtf(a.v[lane]);
        return result;
#endif
    }
    TALUS_INLINE friend Lanes opaque(const Lanes& a) {
        Floats v = a.v;
#ifndef __clang__  // it allows a register of 512 bits here only where the whole file is compiled for AVX-512
        __asm__("" : "+x"(v));
#endif
        return Lanes(v);
    }
    /// Towards zero; for values that fit an int.
    TALUS_INLINE friend LaneInts<count> truncated(const Lanes& a) {
        return {__builtin_convertvector(a.v, Ints)};
    }
    TALUS_INLINE static Lanes from(const LaneInts<count>& ints) {
        return Lanes(Floats(__builtin_convertvector(ints.v, Floats)));
    }
};

/// Transposes 4 x 4 numbers within every block of 128 bits; its own inverse.
template <int count>
TALUS_INLINE Quads<Lanes<count>> transposed(const Quads<Lanes<count>>& r) {
    using T = LaneTypes<count>;
    const auto xy01 = T::Low::shuffled(r.x.v, r.y.v), zw01 = T::High::shuffled(r.x.v, r.y.v);
    const auto xy23 = T::Low::shuffled(r.z.v, r.w.v), zw23 = T::High::shuffled(r.z.v, r.w.v);
    return {T::LowPairs::shuffled(xy01, xy23), T::HighPairs::shuffled(xy01, xy23), T::LowPairs::shuffled(zw01, zw23),
            T::HighPairs::shuffled(zw01, zw23)};
}

/// The rows that `row(lane)` points to: a load of 16 bytes each and a transposition. A gather instruction per number
/// costs several times as much (measured on Zen 4).
template <int count, class Row>
TALUS_INLINE Quads<Lanes<count>> quads_from(const Row& row) {
    const auto rows = [&](int first) __attribute__((always_inline)) {
        return Lanes<count>(LaneTypes<count>::joined([&](int block) __attribute__((always_inline)) {
            FourFloats four;
            __builtin_memcpy(&four, row(first + 4 * block), sizeof four);
            return four;
        }));
    };
    return transposed(Quads<Lanes<count>>{rows(0), rows(1), rows(2), rows(3)});
}

/// The rows of eight that `row(lane)` points to.
template <int count, class Row>
TALUS_INLINE Octs<Lanes<count>> octs_from(const Row& row) {
    if constexpr (count == 4) {
        const auto high = [&](int lane) __attribute__((always_inline)) {
            return row(lane) + 4;
        };
        return {quads_from<count>(row), quads_from<count>(high)};
    } else {
        const auto eight = [&](int lane) __attribute__((always_inline)) {
            EightFloats floats;
            __builtin_memcpy(&floats, row(lane), sizeof floats);
            return floats;
        };
        // Four rows per register, or two: after the transposition their halves alternate block by block.
        const auto rows = [&](int first) __attribute__((always_inline)) {
            if constexpr (count == 8) {
                return Lanes<count>(eight(first));
            } else {
                return Lanes<count>(__builtin_shufflevector(eight(first), eight(first + 4), 0, 1, 2, 3, 4, 5, 6, 7, 8,
                                                            9, 10, 11, 12, 13, 14, 15));
            }
        };
        constexpr int half = count / 2;
        const auto a = transposed(Quads<Lanes<count>>{rows(0), rows(1), rows(2), rows(3)});
        const auto b = transposed(Quads<Lanes<count>>{rows(half), rows(half + 1), rows(half + 2), rows(half + 3)});
        using T = LaneTypes<count>;
        return {{T::EvenBlocks::shuffled(a.x.v, b.x.v), T::EvenBlocks::shuffled(a.y.v, b.y.v),
                 T::EvenBlocks::shuffled(a.z.v, b.z.v), T::EvenBlocks::shuffled(a.w.v, b.w.v)},
                {T::OddBlocks::shuffled(a.x.v, b.x.v), T::OddBlocks::shuffled(a.y.v, b.y.v),
                 T::OddBlocks::shuffled(a.z.v, b.z.v), T::OddBlocks::shuffled(a.w.v, b.w.v)}};
    }
}

/// rows[index] for every lane.
template <int count>
TALUS_INLINE Octs<Lanes<count>> octs_at(const Oct* rows, const std::uint32_t* index) {
    return octs_from<count>([&](int lane) __attribute__((always_inline)) { return rows[index[lane]].v.data(); });
}
/// Half a row: the first four numbers (part 0) or the last (part 1).
template <int count, int part>
TALUS_INLINE Quads<Lanes<count>> quads_at(const Oct* rows, const std::uint32_t* index) {
    return quads_from<count>([&](int lane)
                                 __attribute__((always_inline)) { return rows[index[lane]].v.data() + 4 * part; });
}
template <int count>
TALUS_INLINE Octs<Lanes<count>> load_octs(const Oct* rows) {
    return octs_from<count>([&](int lane) __attribute__((always_inline)) { return rows[lane].v.data(); });
}
template <int count, int part>
TALUS_INLINE Quads<Lanes<count>> load_quads(const Oct* rows) {
    return quads_from<count>([&](int lane) __attribute__((always_inline)) { return rows[lane].v.data() + 4 * part; });
}
template <int count, int part>
TALUS_INLINE void store_quads(const Quads<Lanes<count>>& quads, Oct* rows) {
    const Quads<Lanes<count>> r = transposed(quads);
    const auto put = [&](int first, const Lanes<count>& from) __attribute__((always_inline)) {
        LaneTypes<count>::split(
            from.v, [&](int block, const FourFloats& four) __attribute__((always_inline)) {
                __builtin_memcpy(rows[first + 4 * block].v.data() + 4 * part, &four, sizeof four);
            });
    };
    put(0, r.x);
    put(1, r.y);
    put(2, r.z);
    put(3, r.w);
}

}  // namespace talus::simd

// Found by formulas that do not include this file through argument-dependent lookup on Quad.
namespace talus {

/// rows[index] for every lane.
template <int count>
TALUS_INLINE auto quads_at(const Quad* rows, const simd::LaneInts<count>& index) {
    return simd::quads_from<count>([&](int lane) __attribute__((always_inline)) { return rows[index[lane]].data(); });
}
/// rows[index] and rows[index + 1].
template <int count>
TALUS_INLINE auto quad_pairs_at(const Quad* rows, const simd::LaneInts<count>& index) {
    return simd::octs_from<count>([&](int lane) __attribute__((always_inline)) { return rows[index[lane]].data(); });
}

}  // namespace talus
