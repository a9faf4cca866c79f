#pragma once

#include <string>

#include "ensemble/ensemble_products.hpp"
#include "report/results.hpp"

/// The tables of an ensemble's report, as data.
namespace talus::ensemble {

/// "7 %"; a dash where there is no number.
[[nodiscard]] std::string percent(double share);

/// Barriers are among the structures, but are no buildings.
[[nodiscard]] bool is_barrier(const EnsembleResult& result, std::size_t structure);

/// Buildings by how often they are hit; null where none is.
[[nodiscard]] report::Json buildings_of(const EnsembleResult& result);
/// Quantiles of every result, and what was observed.
[[nodiscard]] report::Json results_of(const EnsembleResult& result);
/// null where particles alone were run.
[[nodiscard]] report::Json two_models_of(const EnsembleResult& result);
/// null where none failed.
[[nodiscard]] report::Json failed_runs(const EnsembleResult& result);

}  // namespace talus::ensemble
