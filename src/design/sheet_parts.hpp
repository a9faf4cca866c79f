#pragma once

#include <string>
#include <vector>

#include "design/design.hpp"
#include "design/loads.hpp"
#include "report/chart.hpp"
#include "report/table.hpp"

/// The parts of the sheet, as data.
namespace talus::design {

/// Peaks of the runs with the barrier at the height that is shown.
struct Peaks {
    Spread force_per_metre, pressure, run_up, retained, passing;
};
[[nodiscard]] Peaks peaks_of(const LineResult& line);
/// What the published methods are given: 95th percentiles of the undisturbed flow.
[[nodiscard]] Approach approach_of(const DesignResult& result, const LineResult& line);

[[nodiscard]] report::Json trials_table(const LineResult& line);
[[nodiscard]] report::Json spreads_table(const LineResult& line);
[[nodiscard]] report::Json loads_table(const DesignResult& result);
[[nodiscard]] report::Json lines_table(const DesignResult& result);
[[nodiscard]] report::Json confirmed_table(const LineResult& line);

/// Ground across the middle of the line with the barrier, what it holds, the flow that comes and its run-up.
[[nodiscard]] std::string section_svg(const DesignResult& result);
/// Capacity against height.
[[nodiscard]] report::Json capacity_chart(const DesignResult& result);
/// Filling over time, and force per metre beside the published methods.
[[nodiscard]] report::Json time_chart(const DesignResult& result);

[[nodiscard]] std::vector<std::string> assumptions_of(const DesignResult& result);
[[nodiscard]] std::vector<std::string> limits_of(const DesignResult& result);

}  // namespace talus::design
