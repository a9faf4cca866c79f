#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.hpp"

namespace talus::terrain {

/// Items by where they lie in plan: square bins, each with the indices of the items whose extents reach into it.
class PlanBins {
  public:
    PlanBins() = default;
    /// `extents` of the items, local. `smallest`: edge of a bin, m; larger where there would be over a million bins.
    PlanBins(std::span<const Extent> extents, double smallest);

    /// Items whose extents contain a local plan position, and others near it, ascending. One table look-up.
    [[nodiscard]] std::span<const std::uint32_t> near(double x, double y) const {
        const double u = (x - x_min_) / edge_, v = (y - y_min_) / edge_;
        if (!(u >= 0 && v >= 0 && u < columns_ && v < rows_)) return {};  // also for NaN
        const std::size_t bin = index(static_cast<int>(u), static_cast<int>(v));
        return {items_.data() + start_[bin], items_.data() + start_[bin + 1]};
    }

  private:
    [[nodiscard]] std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }

    double x_min_ = 0, y_min_ = 0, edge_ = 1;
    int columns_ = 0, rows_ = 0;
    std::vector<std::uint32_t> start_, items_;  // start_ has one entry more than there are bins
};

}  // namespace talus::terrain
