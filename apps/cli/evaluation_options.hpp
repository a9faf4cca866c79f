#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/result.hpp"
#include "ensemble/plan.hpp"

namespace talus::cli {

/// What is made of the runs: may be changed later, by `merge`.
struct Evaluation {
    std::string depths, speeds, pressures;  ///< thresholds "0.5,1"; empty: the plan's
    std::optional<double> return_period;    ///< years; absent: the plan's
};

/// --depth-m, --speed-mps, --pressure-kPa, --return-period.
void add_evaluation(CLI::App& command, Evaluation& evaluation);

/// Those that are given, in the plan. Errors: out of range.
[[nodiscard]] Status set_evaluation(ensemble::EnsemblePlan& plan, const Evaluation& evaluation);

}  // namespace talus::cli
