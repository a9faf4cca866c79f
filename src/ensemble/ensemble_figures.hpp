#pragma once

#include <string>

#include "ensemble/ensemble_products.hpp"

/// The figures of an ensemble's report, as HTML.
namespace talus::report {

/// Histogram of run-out with its percentiles, and the share of runs that go farther.
[[nodiscard]] std::string run_out_figure(const EnsembleResult& result, int number);

/// For every result, how much it depends on each factor: bars, whose meaning follows the design.
[[nodiscard]] std::string sensitivity_figure(const EnsembleResult& result, int number);

/// Run-out against each numeric factor, a dot per run; empty without any.
[[nodiscard]] std::string scatter_figure(const EnsembleResult& result, int number);

}  // namespace talus::report
