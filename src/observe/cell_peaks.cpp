// Peaks of the cells of the depth-averaged model. Compiled once per instruction set by Highway's foreach_target.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "observe/cell_peaks.cpp"
#include <hwy/foreach_target.h>
// (must come after foreach_target)
#include <algorithm>
#include <hwy/highway.h>

#include "observe/cell_peaks.hpp"
#include "observe/grid_flow.hpp"
#include "simd/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::observe::HWY_NAMESPACE {
namespace {

constexpr int lane_count = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;
using L = simd::Lanes<lane_count>;

[[gnu::flatten]] void raise_peaks(const depth::CellRow& row, float thinnest, float* depth, float* speed) {
    const int count = row.last - row.first;
    int k = 0;
    for (; k + lane_count <= count; k += lane_count) {
        const L there = L::load(row.depth + k);
        const auto deep = there > L(thinnest);
        if (!any(deep)) continue;
        const L now = speed_of(L::load(row.u + k), L::load(row.v + k), L::load(row.slope_x + k),
                               L::load(row.slope_y + k), row.climb == nullptr ? L(0) : L::load(row.climb + k));
        larger(L::load(depth + k), select(deep, there, L(0))).store(depth + k);
        larger(L::load(speed + k), select(deep, now, L(0))).store(speed + k);
    }
    for (; k < count; ++k) {
        if (!(row.depth[k] > thinnest)) continue;
        depth[k] = std::max(depth[k], row.depth[k]);
        speed[k] = std::max(speed[k], speed_of(row, k));
    }
}

RaisePeaks make_raise_peaks() {
    return raise_peaks;
}

}  // namespace
}  // namespace talus::observe::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace talus::observe {

HWY_EXPORT(make_raise_peaks);

RaisePeaks raise_peaks_function() {
    return HWY_DYNAMIC_DISPATCH(make_raise_peaks)();
}

}  // namespace talus::observe
#endif
