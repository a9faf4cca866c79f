#pragma once

#include <cstddef>

#include "simd/parallel.hpp"

namespace talus::report {

/// Calls f(row) for every row of a picture or a grid, some of them at the same time.
template <class F>
void for_rows(int rows, const F& f) {
    constexpr std::size_t grain = 16;
    simd::parallel_ranges(static_cast<std::size_t>(rows), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row < last; ++row) f(static_cast<int>(row));
    });
}

}  // namespace talus::report
