#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/result.hpp"
#include "ensemble/plan.hpp"

namespace talus::cli {

/// The sample of uncertain factors that a command repeats for each of its cases.
struct SampleOptions {
    std::string plan;                  ///< a plan file; empty: options alone
    std::vector<std::string> factors;  ///< "section.key=distribution"
    std::optional<std::string> design;
    std::optional<std::size_t> runs;
    std::optional<std::uint64_t> seed;
};

/// --plan, --vary, --design, --runs, --seed; `runs_help` says of what the runs are, and how many by default.
void add_sample_options(CLI::App& command, SampleOptions& options, const std::string& runs_help);

/// Errors: as read_plan and add_factor; a design whose points are no sample; runs of the fast model beside (`instead`
/// says what to set).
[[nodiscard]] Result<ensemble::EnsemblePlan> read_sample(const SampleOptions& options, std::size_t default_runs,
                                                         const std::string& instead);

}  // namespace talus::cli
