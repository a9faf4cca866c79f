#pragma once

#include "ensemble/ensemble_products.hpp"
#include "report/chart.hpp"

/// The figures of an ensemble's report, as data; null where there is nothing to draw.
namespace talus::ensemble {

/// Histogram of run-out along the flow with its percentiles, and the share of runs with a longer one.
[[nodiscard]] report::Json run_out_chart(const EnsembleResult& result);

/// For every result, its sensitivity to each factor, by the measure that belongs to the design.
[[nodiscard]] report::Json sensitivity_data(const EnsembleResult& result);
/// Sensitivity as bars: a drawing for the report.
[[nodiscard]] std::string sensitivity_svg(const report::Json& sensitivity);

/// Run-out along the flow against each numeric factor, a dot per run.
[[nodiscard]] report::Json scatter_chart(const EnsembleResult& result);

}  // namespace talus::ensemble
