#pragma once

#include <algorithm>

namespace talus::depth {

/// The state of cells side by side in a row: columns [first, last), pointers to the first.
struct CellRow {
    int row = 0, first = 0, last = 0;
    const float *depth = nullptr, *u = nullptr, *v = nullptr;  ///< m, m/s
    const float *slope_x = nullptr, *slope_y = nullptr;        ///< of the ground
    const float* climb = nullptr;                              ///< m/s, see Solver::climb_at(); null: 0
};

/// Calls f(k) for every k below `count` for which holds(k) is true. Fast where that is true of few: sixteen are checked
/// at once. holds(k) may be called twice, and again after f has changed what it depends on.
template <class Holds, class F>
void for_each_of_few(int count, const Holds& holds, const F& f) {
    constexpr int strip = 16;
    for (int first = 0; first < count; first += strip) {
        const int last = std::min(first + strip, count);
        int found = 0;
        for (int k = first; k < last; ++k) found += holds(k) ? 1 : 0;
        for (int k = first; k < last && found > 0; ++k) {
            if (holds(k)) f(k);
        }
    }
}

/// Calls f(k) for every cell first + k of a row with debris deeper than `limit`, m.
template <class F>
void for_each_deeper(const CellRow& row, float limit, const F& f) {
    for_each_of_few(
        row.last - row.first, [&](int k) { return row.depth[k] > limit; }, f);
}

}  // namespace talus::depth
