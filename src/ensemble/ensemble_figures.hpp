#pragma once

#include "ensemble/ensemble_products.hpp"
#include "report/chart.hpp"

/// The figures of an ensemble's report, as data; null where there is nothing to draw.
namespace talus::report {

/// Histogram of run-out with its percentiles, and the share of runs that go farther.
[[nodiscard]] Json run_out_chart(const EnsembleResult& result);

/// For every result, how much of it depends on each factor, by the measure that follows from the design.
[[nodiscard]] Json sensitivity_data(const EnsembleResult& result);
/// That as bars: a drawing for the report.
[[nodiscard]] std::string sensitivity_svg(const Json& sensitivity);

/// Run-out against each numeric factor, a dot per run.
[[nodiscard]] Json scatter_chart(const EnsembleResult& result);

}  // namespace talus::report
