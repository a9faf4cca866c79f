#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/lanes.hpp"

/// The operations of simd/lanes.hpp and lane_pairs.hpp on arrays, one function for all instruction sets.
namespace talus::test {

/// A multiple of any number of lanes.
inline constexpr std::size_t block = 16;
using Floats = std::array<float, block>;
using Flags = std::array<bool, block>;
using Ints = std::array<std::int32_t, block>;
using Places = std::array<std::uint32_t, block>;
using Rows = std::array<simd::Oct, block>;
using QuadRows = std::array<Quad, block + 1>;

struct Arithmetic {
    Floats sum{}, difference{}, product{}, quotient{}, negative{}, added_to{}, multiplied_by{}, root{}, same{};
    Floats larger{}, smaller{};
};
struct Comparisons {
    Flags less{}, greater{}, at_most{}, at_least{}, equal{}, unequal{};
    Flags both{}, either{}, no{};  ///< at most and at least; less or equal; not less
    Flags any{};                   ///< of the lanes of a register: less
    Floats chosen{};               ///< where less the first, else the second
};
struct Numbers {
    Floats zero{}, of_float{}, of_double{}, of_int{}, of_size{};
    Floats set_one_by_one{}, read_one_by_one{};
};
struct WholeNumbers {
    Ints truncated{}, sum{}, threefold{};
    Floats back{}, from_index{};
};
/// Rows of eight, and of four, as they come out of vectors again.
struct Gathers {
    Rows octs_at{}, load_octs{}, quads_at{}, load_quads{}, stored{}, transposed_twice{};
    std::array<Quad, block> quads_of_quads{};
    Rows pairs_of_quads{};
};

struct LaneKernels {
    const char* instruction_set;
    int lanes;
    void (*calculate)(const Floats& a, const Floats& b, Arithmetic& to);
    void (*compare)(const Floats& a, const Floats& b, Comparisons& to);
    void (*spread)(float number, std::int32_t whole, const Floats& numbers, Numbers& to);
    void (*count)(const Floats& a, const Floats& b, WholeNumbers& to);
    void (*gather)(const Rows& rows, const QuadRows& quads, const Places& places, Gathers& to);
    // Of simd/lane_pairs.hpp, without what it lacks.
    int lanes_of_pairs;
    void (*calculate_pairs)(const Floats& a, const Floats& b, Arithmetic& to);
    void (*compare_pairs)(const Floats& a, const Floats& b, Comparisons& to);
};

/// Those of the chosen instruction set (simd/dispatch.hpp).
[[nodiscard]] LaneKernels lane_kernels();

}  // namespace talus::test
