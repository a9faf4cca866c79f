#pragma once

#include "ensemble/ensemble_products.hpp"
#include "report/chart.hpp"

/// The figures of an ensemble's report, as data; null where there is nothing to draw.
namespace talus::report {

/// Histogram of run-out with its percentiles, and the share of runs that go farther.
[[nodiscard]] Json run_out_chart(const EnsembleResult& result);

/// For every result, how much of it depends on each factor: bars, drawn, whose meaning follows the design.
[[nodiscard]] Json sensitivity_figure(const EnsembleResult& result);

/// Run-out against each numeric factor, a dot per run.
[[nodiscard]] Json scatter_chart(const EnsembleResult& result);

}  // namespace talus::report
