#include "calibrate/recovery.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrate/calibration_products.hpp"
#include "core/try.hpp"
#include "ensemble/ensemble.hpp"
#include "products/csv.hpp"

namespace talus::calibrate {
namespace {

constexpr std::size_t max_draws_per_seed = 5;

/// Whether a run predicts every observation itself.
bool sees_everything(const ensemble::RunRecord& record, std::size_t observations) {
    return record.complete() && record.results.size() >= observations &&
           std::all_of(record.results.end() - static_cast<std::ptrdiff_t>(observations), record.results.end(),
                       [](double v) { return std::isfinite(v); });
}

/// Synthetic observations of a run, each with an error.
std::vector<ensemble::ObservedValue> observe(const ensemble::RunRecord& record, std::vector<ensemble::ObservedValue> as,
                                             std::uint64_t seed) {
    const auto first = record.results.end() - static_cast<std::ptrdiff_t>(as.size());
    for (std::size_t j = 0; j < as.size(); ++j) {
        const double seen = first[static_cast<std::ptrdiff_t>(j)] + as[j].uncertainty * stats::normal_draw(seed, 1, j);
        if (as[j].kind == ensemble::ObservedValue::Kind::equal) {
            as[j].value = seen;
        } else {  // the limit is kept; observed is on which side of it the building appears to be
            as[j].kind =
                seen >= as[j].value ? ensemble::ObservedValue::Kind::at_least : ensemble::ObservedValue::Kind::below;
        }
    }
    return as;
}

}  // namespace

bool RecoverySeed::returned() const {
    for (std::size_t k = 0; k < truth.size(); ++k) {
        if (!returned(k)) return false;
    }
    return true;
}

Result<Recovery> recover(const CalibrationPlan& plan, const ensemble::PlannedRuns& runs, const run::SceneSource& source,
                         const scene::Scene& base, const std::string& scene_name, const std::filesystem::path& folder,
                         std::size_t seeds, const CalibrationOptions& options,
                         const std::function<void(std::size_t)>& on_seed) {
    const std::vector<ensemble::ObservedValue> observed = ensemble::observed_values(base);
    Recovery made;
    made.factors = runs.plan().factors;

    ensemble::PlannedRuns truths = runs;
    TALUS_ASSIGN(const auto all, ensemble::EnsembleFolder::open(
                                     folder / "truths", calibration_definition("set of known runs", plan, runs, source,
                                                                               base, observed, scene_name)));
    std::vector<ensemble::RunRecord> records;
    run::WorkClock clock(std::vector<double>(max_draws_per_seed * seeds, 1), options.runs_at_once);
    const ForwardModel model =
        scene_model(truths, source, observed, all, options, {max_draws_per_seed * seeds, &records, &clock});
    std::vector<std::size_t> usable;
    stats::Points points;
    while (usable.size() < seeds) {
        if (points.size() >= max_draws_per_seed * seeds) {
            return Error{
                fmt::format("of {} runs with values from these ranges only {} brought debris to every observation; "
                            "narrow the ranges",
                            points.size(), usable.size())};
        }
        points =
            sample_points(stats::DesignKind::monte_carlo, points.size() + seeds, made.factors.size(), plan.search.seed);
        TALUS_ASSIGN(const auto predicted, model(points, SearchPhase::design));
        if (!predicted) {
            made.interrupted = true;
            return made;
        }
        usable.clear();
        for (std::size_t i = 0; i < records.size(); ++i) {
            if (sees_everything(records[i], observed.size())) usable.push_back(i);
        }
    }

    for (std::size_t i = 0; i < seeds; ++i) {
        if (on_seed) on_seed(i);
        CalibrationPlan one = plan;
        one.search.seed = plan.search.seed + i;
        const std::vector<ensemble::ObservedValue> seen = observe(records[usable[i]], observed, one.search.seed);
        TALUS_ASSIGN(const auto place,
                     ensemble::EnsembleFolder::open(
                         folder / fmt::format("seed_{:02}", i + 1),
                         calibration_definition("calibration", one, runs, source, base, seen, scene_name)));
        TALUS_ASSIGN(const auto found, calibrate(one, runs, source, base, seen, place, options));
        if (found.result.interrupted) {
            made.interrupted = true;
            return made;
        }
        const CalibrationSummary summary = summarise(found);
        RecoverySeed& seed = made.seeds.emplace_back();
        seed.seed = one.search.seed;
        seed.runs = found.result.runs.size();
        for (std::size_t k = 0; k < made.factors.size(); ++k) {
            seed.truth.push_back(made.factors[k].distribution.quantile(points[usable[i]][k]));
            seed.low.push_back(summary.factors[k].low);
            seed.high.push_back(summary.factors[k].high);
            seed.median.push_back(summary.factors[k].median);
            seed.widest_r_hat = std::max(seed.widest_r_hat, summary.factors[k].r_hat);
        }
    }
    return made;
}

std::string recovery_table(const Recovery& recovery) {
    products::Csv csv("seed,factor,truth,median,low_95,high_95,returned,runs,r_hat");
    for (const RecoverySeed& seed : recovery.seeds) {
        for (std::size_t k = 0; k < recovery.factors.size(); ++k) {
            csv.number(static_cast<double>(seed.seed)).word(recovery.factors[k].key).number(seed.truth[k]);
            csv.number(seed.median[k]).number(seed.low[k]).number(seed.high[k]).word(seed.returned(k) ? "yes" : "no");
            csv.number(static_cast<double>(seed.runs)).number(seed.widest_r_hat).end_row();
        }
    }
    return csv.text();
}

}  // namespace talus::calibrate
