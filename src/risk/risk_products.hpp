#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "report/hazard_map.hpp"
#include "risk/risk.hpp"
#include "risk/study.hpp"

/// What is written of a study: maps, tables, results.json and a report.
namespace talus::risk {

/// The evaluated ensembles of a study. It must outlive this.
struct StudyResult {
    const Study* study = nullptr;
    std::vector<OptionOutcome> outcomes;  ///< by option; the first is the base
    std::vector<Risk> risks;              ///< likewise
    std::vector<Risk> differences;        ///< likewise, from the base, pair by pair; the first is empty
    [[nodiscard]] const scene::Scene& scene() const { return *study->parts.front().scene; }
    /// The option of that place in the scene file; nullptr: the ground without options.
    [[nodiscard]] const params::OptionSpec* option(std::size_t index) const;
    /// "As it is", or its name.
    [[nodiscard]] std::string name_of(std::size_t option) const;
};

/// Reads all ensembles, which are complete. Errors: as read_outcome.
[[nodiscard]] Result<StudyResult> summarise(const Study& study);

/// Maps of each option (COG with .qml), risk.gpkg with buildings and roads, results.qlr, risk.csv, fn.csv, options.csv
/// and differences.csv where there are options, results.json and report.html, over those of an earlier call.
[[nodiscard]] Status write_study(const StudyResult& result, const std::filesystem::path& folder);

/// What the report shows, as data.
[[nodiscard]] nlohmann::ordered_json risk_results(const StudyResult& result);

/// The self-contained page of `results`. Errors: a picture could not be encoded.
[[nodiscard]] Result<std::string> risk_report(const StudyResult& result, const nlohmann::ordered_json& results);

/// The F-N curves of all options against the criteria, on logarithmic axes.
[[nodiscard]] std::string fn_svg(const StudyResult& result);

/// Every assumption on which the numbers rest, and what the model leaves out: a sentence each.
[[nodiscard]] std::vector<std::string> assumptions_of(const StudyResult& result);
[[nodiscard]] std::vector<std::string> limits_of(const StudyResult& result);

/// How a map is called and coloured, and its file: that of the debris, of individual risk.
[[nodiscard]] report::HazardMap debris_style(const StudyResult& result, std::size_t option);
[[nodiscard]] report::HazardMap individual_style(const StudyResult& result, std::size_t option);

}  // namespace talus::risk
