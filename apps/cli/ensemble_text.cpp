#include "ensemble_text.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/number_or_null.hpp"
#include "progress.hpp"

namespace talus::cli {
namespace {

std::string number_text(double value) {
    return std::isfinite(value) ? fmt::format("{:.4g}", value) : std::string("-");
}

std::string two_models_text(const ensemble::TwoModels& both) {
    std::string text = fmt::format("\nwith {} runs of the depth-averaged model, {} beside particles\n",
                                   both.fast_complete, both.pairs);
    text += fmt::format("{:<40}{:>22}{:>22}  {}\n", "mean of", "particles alone", "with both", "unit");
    const auto row = [&](const ensemble::TwoModelMean& m, const std::string& name, double factor, const char* unit) {
        const auto with_error = [&](double mean, double error) {
            return fmt::format("{:.4g} +- {:.2g}", factor * mean, factor * error);
        };
        text += fmt::format("{:<40}{:>22}{:>22}  {}\n", name, with_error(m.mean.plain, m.mean.plain_error),
                            with_error(m.mean.mean, m.mean.error), unit);
    };
    for (const ensemble::TwoModelMean& m : both.results) row(m, m.name, 1, m.unit.c_str());
    for (const ensemble::TwoModelMean& m : both.buildings) row(m, "hits of " + m.name, 100, "%");
    return text;
}

}  // namespace

std::string ensemble_text(const ensemble::EnsembleResult& result, const std::filesystem::path& folder) {
    const ensemble::Reduction& r = result.reduction;
    std::string text = fmt::format("{} of {} runs complete, {} failed{}\n\n", r.complete, result.runs->count(),
                                   r.failed, r.missing.empty() ? "" : fmt::format(", {} not run", r.missing.size()));
    const run::RunVerdict verdict = judge_together(r.runs);
    for (const std::string& warning : verdict.warnings()) text += "! " + warning + "\n";
    if (!verdict.within_limits()) text += "\n";
    text += fmt::format("{:<40}{:>10}{:>10}{:>10}  {}\n", "result", "5 %", "median", "95 %", "unit");
    for (std::size_t m = 0; m < result.measures.size(); ++m) {
        std::vector<double> values = result.values_of(m);
        text += fmt::format("{:<40}{:>10}{:>10}{:>10}  {}\n", result.measures[m].name,
                            number_text(ensemble::percentile(values, 5)), number_text(ensemble::percentile(values, 50)),
                            number_text(ensemble::percentile(values, 95)), result.measures[m].unit);
    }
    std::size_t shown = 0;
    for (const ensemble::BuildingOdds& b : r.buildings) {
        if (b.hit <= 0) continue;
        if (shown++ == 0) text += "\nbuilding, share of runs that hit it\n";
        if (shown <= 12) text += fmt::format("{:<40}{:>9.0f} %\n", b.name.empty() ? "unnamed" : b.name, 100 * b.hit);
    }
    if (shown > 12) text += fmt::format("and {} more, see buildings.csv\n", shown - 12);
    if (result.two_models) text += two_models_text(*result.two_models);
    return text + fmt::format("\n{}\n", (folder / "report.html").string());
}

std::string ensemble_json(const ensemble::EnsembleResult& result, const std::filesystem::path& folder) {
    nlohmann::ordered_json json = {{"event", "result"}, {"folder", folder.string()}};
    json.update(statistics_json(result));
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string progress_text(const ensemble::EnsembleProgress& p) {
    std::string text = fmt::format("{} of {} runs", p.done + p.failed, p.count);
    if (p.failed > 0) text += fmt::format(", {} failed", p.failed);
    if (p.runs_per_minute > 0) text += fmt::format(", {:.3g} runs per minute", p.runs_per_minute);
    return text + left_text(", about {} left", p.wall_remaining);
}

std::string progress_json(const ensemble::EnsembleProgress& p) {
    const nlohmann::ordered_json json = {
        {"event", "progress"},
        {"runs_done", p.done},
        {"runs_failed", p.failed},
        {"runs", p.count},
        {"share_done", p.share_done},
        {"runs_per_minute", p.runs_per_minute},
        {"wall_remaining_s", number_or_null<nlohmann::ordered_json>(p.wall_remaining)},
    };
    return json.dump();
}

}  // namespace talus::cli
