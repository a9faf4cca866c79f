#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.hpp"

namespace talus::terrain {

/// The bins of PlanBins by pointers: see there. It owns nothing.
struct PlanBinItems {
    double x_min = 0, y_min = 0, edge = 1;
    int columns = 0, rows = 0;
    const std::uint32_t *start = nullptr, *items = nullptr;

    [[nodiscard]] TALUS_DEVICE std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    }
    /// Items whose extents contain a local plan position, and others near it, ascending. One table look-up.
    [[nodiscard]] TALUS_DEVICE std::span<const std::uint32_t> near(double x, double y) const {
        const double u = (x - x_min) / edge, v = (y - y_min) / edge;
        if (!(u >= 0 && v >= 0 && u < columns && v < rows)) return {};  // also for NaN
        const std::size_t bin = index(static_cast<int>(u), static_cast<int>(v));
        return {items + start[bin], items + start[bin + 1]};
    }
};

/// Items by where they lie in plan: square bins, each with the indices of the items whose extents reach into it.
class PlanBins {
  public:
    PlanBins() = default;
    /// `extents` of the items, local. `smallest`: edge of a bin, m; larger where there would be over a million bins.
    PlanBins(std::span<const Extent> extents, double smallest);

    /// See PlanBinItems.
    [[nodiscard]] std::span<const std::uint32_t> near(double x, double y) const { return view().near(x, y); }
    /// For whoever computes elsewhere: valid as long as the bins.
    [[nodiscard]] PlanBinItems view() const {
        PlanBinItems result = box_;
        result.start = start_.data();
        result.items = items_.data();
        return result;
    }
    [[nodiscard]] const std::vector<std::uint32_t>& starts() const { return start_; }
    [[nodiscard]] const std::vector<std::uint32_t>& items() const { return items_; }

    template <class Archive>
    void keep(Archive& archive) {
        archive(box_.x_min, box_.y_min, box_.edge, box_.columns, box_.rows, start_, items_);
    }

  private:
    PlanBinItems box_;                          // without its pointers
    std::vector<std::uint32_t> start_, items_;  // start_ has one entry more than there are bins
};

}  // namespace talus::terrain
