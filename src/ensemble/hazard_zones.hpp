#pragma once

#include <string>
#include <vector>

#include "core/grid.hpp"
#include "params/spec.hpp"
#include "report/hazard_map.hpp"

/// Zones of a hazard map: how intense debris is at a place, and how often. Published matrices are tables of data.
namespace talus::ensemble {

struct HazardMatrix {
    std::string name, citation, remark;
    std::vector<double> periods;          ///< upper limits of the classes of return period, years; the last is open
    std::vector<report::Category> zones;  ///< the least dangerous first
    std::vector<std::vector<int>> zone;   ///< by intensity class and class of return period: 1 + a zone; 0: none

    /// 1 + the zone for an intensity class (from 0) with a return period in years; 0: none.
    [[nodiscard]] int zone_of(std::size_t intensity, double return_period) const;
};

/// The matrix that goes with a guideline's classes; nullptr: none is known.
[[nodiscard]] const HazardMatrix* hazard_matrix(params::GuidelineChoice guideline);

/// The most dangerous zone of any intensity at each place; NaN: none. `at_least`: per class the share of runs with that
/// intensity or a higher one. `return_period`: years between events of which the runs are samples.
[[nodiscard]] Grid<float> hazard_zones(const HazardMatrix& matrix, const std::vector<Grid<float>>& at_least,
                                       double return_period);

/// How the zones are written and drawn.
[[nodiscard]] report::HazardMap zone_style(const HazardMatrix& matrix);

}  // namespace talus::ensemble
