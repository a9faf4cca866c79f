#include "calibrate_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibration_products.hpp"
#include "core/number_or_null.hpp"
#include "progress.hpp"

namespace talus::cli {
namespace {

using Json = nlohmann::ordered_json;

/// How the two models relate for one observation.
std::string model_line(const ensemble::ObservedValue& observed, const calibrate::ObservationResult& o) {
    if (o.pairs == 0) return fmt::format("{:<38}no pair of runs has a value\n", observed.name);
    return fmt::format("{:<38}{:+.3g} +- {:.2g} {} in {} pairs; rho {:.2f}\n", observed.name, o.model_difference,
                       o.model_spread, observed.unit, o.pairs, o.rho);
}

}  // namespace

std::string calibration_text(const calibrate::Calibration& c, const std::filesystem::path& folder) {
    const calibrate::CalibrationSummary s = summarise(c);
    const calibrate::SearchResult& r = c.result;
    const calibrate::FastRuns& fast = s.fast;
    const bool two = fast.made > 0;
    std::string text = fmt::format("{} runs{}, {} failed", r.runs.size(), two ? " of particles" : "", s.failed);
    if (two) text += fmt::format("; {} of the depth-averaged model, {} failed", fast.made, fast.failed);
    text += fmt::format("; {}\nleast misfit {:.3g} in run {}\n\n",
                        r.settled ? "no further gain expected" : "stopped at the maximum number of runs",
                        r.runs[*r.best].misfit, *r.best);
    text += fmt::format("{:<38}{:>11}{:>11}{:>11}{:>11}{:>12}\n", "factor", "best fit", "median", "95 % from", "to",
                        "width left");
    for (std::size_t k = 0; k < s.factors.size(); ++k) {
        const calibrate::FactorResult& f = s.factors[k];
        text += fmt::format("{:<38}{:>11.4g}{:>11.4g}{:>11.4g}{:>11.4g}{:>10.0f} %\n", c.factors[k].key, f.best,
                            f.median, f.low, f.high, 100 * f.kept);
    }
    text += fmt::format("\n{:<38}{:>11}{:>11}{:>11}{:>11}{:>12}  {}\n", "observation", "observed", "+-", "best fit",
                        "off by", "emulator +-", "unit");
    for (std::size_t j = 0; j < s.observations.size(); ++j) {
        const calibrate::ObservationResult& o = s.observations[j];
        text += fmt::format("{:<38}{:>11.4g}{:>11.3g}{:>11}{:>11.1f}{:>12.3g}  {}\n", c.observed[j].name,
                            c.observed[j].value, c.observed[j].uncertainty,
                            std::isfinite(o.best) ? fmt::format("{:.4g}", o.best) : "none", o.deviation, o.left_out,
                            c.observed[j].unit);
    }
    if (two) text += "\nparticles less depth-averaged, where both ran\n";
    for (std::size_t j = 0; two && j < s.observations.size(); ++j) text += model_line(c.observed[j], s.observations[j]);
    for (const auto* records : {&c.records, &c.fast_records}) {
        const auto warnings = ensemble::judge_together(*records).warnings();
        for (const std::string& warning : warnings) {
            text += fmt::format("! {}{}\n",
                                !two                    ? ""
                                : records == &c.records ? "particles: "
                                                        : "depth-averaged: ",
                                warning);
        }
    }
    if (!s.warnings.empty()) text += "\n";
    for (const std::string& warning : s.warnings) text += "! " + warning + "\n";
    return text +
           fmt::format("\n{}\n{}\n", (folder / "report.html").string(), (folder / "best_fit/scene.toml").string());
}

std::string calibration_line(const calibrate::Calibration& c, const std::filesystem::path& folder) {
    Json json = {{"event", "result"}, {"folder", folder.string()}};
    json.update(calibration_json(c));
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string progress_text(const calibrate::CalibrationProgress& p) {
    std::string text = fmt::format("{}: {} of at most {} {}runs", search_phase_name(p.phase), p.done + p.failed, p.most,
                                   p.fast ? "fast " : "");
    if (p.failed > 0) text += fmt::format(", {} failed", p.failed);
    if (std::isfinite(p.least_misfit)) text += fmt::format(", least misfit {:.3g}", p.least_misfit);
    return text + left_text(", at most about {} left", p.wall_remaining);
}

std::string progress_json(const calibrate::CalibrationProgress& p) {
    const Json json = {{"event", "progress"},
                       {"phase", search_phase_name(p.phase)},
                       {"fast", p.fast},
                       {"runs_done", p.done},
                       {"runs_failed", p.failed},
                       {"runs_at_most", p.most},
                       {"least_misfit", number_or_null<Json>(p.least_misfit)},
                       {"wall_remaining_s", number_or_null<Json>(p.wall_remaining)}};
    return json.dump();
}

std::string recovery_text(const calibrate::Recovery& recovery, const std::filesystem::path& folder) {
    std::string text = fmt::format("{:<6}{:<38}{:>11}{:>11}{:>11}{:>11}{:>10}\n", "seed", "factor", "truth", "median",
                                   "95 % from", "to", "returned");
    for (const calibrate::RecoverySeed& seed : recovery.seeds) {
        for (std::size_t k = 0; k < recovery.factors.size(); ++k) {
            text += fmt::format("{:<6}{:<38}{:>11.4g}{:>11.4g}{:>11.4g}{:>11.4g}{:>10}\n", seed.seed,
                                recovery.factors[k].key, seed.truth[k], seed.median[k], seed.low[k], seed.high[k],
                                seed.returned(k) ? "yes" : "no");
        }
    }
    const std::size_t count = recovery.seeds.size();
    text += "\n";
    for (std::size_t k = 0; k < recovery.factors.size(); ++k) {
        const auto hits = std::count_if(recovery.seeds.begin(), recovery.seeds.end(),
                                        [&](const calibrate::RecoverySeed& seed) { return seed.returned(k); });
        text +=
            fmt::format("{} recovered within its interval in {} of {} seeds\n", recovery.factors[k].key, hits, count);
    }
    const auto all = std::count_if(recovery.seeds.begin(), recovery.seeds.end(),
                                   [](const calibrate::RecoverySeed& seed) { return seed.returned(); });
    return text + fmt::format("all together in {} of {}\n{}\n", all, count, (folder / "recovery.csv").string());
}

std::string recovery_json(const calibrate::Recovery& recovery) {
    Json seeds = Json::array();
    for (const calibrate::RecoverySeed& seed : recovery.seeds) {
        seeds.push_back({{"seed", seed.seed},
                         {"truth", seed.truth},
                         {"median", seed.median},
                         {"low_95", seed.low},
                         {"high_95", seed.high},
                         {"returned", seed.returned()},
                         {"runs", seed.runs}});
    }
    Json keys = Json::array();
    for (const ensemble::Factor& f : recovery.factors) keys.push_back(f.key);
    return Json{{"event", "result"}, {"factors", keys}, {"seeds", seeds}}.dump();
}

}  // namespace talus::cli
