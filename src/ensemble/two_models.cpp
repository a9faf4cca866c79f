#include "ensemble/two_models.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <system_error>

#include "core/try.hpp"

namespace talus::ensemble {
namespace {

using Value = std::function<double(const RunRecord&)>;

/// The complete runs of both models, by place.
struct Pairs {
    std::vector<const RunRecord*> slow, fast;  // at the same places
    std::vector<const RunRecord*> more;        // of the fast model at others
};

/// None where a run has no such value, or there are fewer than two pairs.
std::optional<TwoModelMean> mean_of(const Pairs& pairs, const Value& value) {
    const auto values = [&](const std::vector<const RunRecord*>& runs) {
        std::vector<double> all;
        all.reserve(runs.size());
        for (const RunRecord* run : runs) all.push_back(value(*run));
        return all;
    };
    const std::vector<double> slow = values(pairs.slow), fast = values(pairs.fast), more = values(pairs.more);
    const auto known = [](const std::vector<double>& all) {
        return std::all_of(all.begin(), all.end(), [](double v) { return std::isfinite(v); });
    };
    if (slow.size() < 2 || !known(slow) || !known(fast) || !known(more)) return std::nullopt;
    TwoModelMean made;
    made.mean = stats::controlled_mean(slow, fast, more);
    const auto count = static_cast<double>(fast.size() + more.size());
    for (const std::vector<double>* part : {&fast, &more}) {
        for (const double v : *part) made.fast_mean += v / count;
    }
    return made;
}

void add_buildings(const Pairs& pairs, TwoModels& made) {
    std::size_t buildings = 0;
    for (const RunRecord* run : pairs.slow) buildings = std::max(buildings, run->buildings.size());
    for (std::size_t b = 0; b < buildings; ++b) {
        std::optional<TwoModelMean> odds = mean_of(
            pairs, [b](const RunRecord& run) { return b < run.buildings.size() && run.buildings[b].hit ? 1.0 : 0.0; });
        if (!odds || (odds->mean.plain <= 0 && odds->fast_mean <= 0)) continue;
        odds->key = "hit";
        odds->name = pairs.slow.front()->buildings[b].name;
        odds->mean.mean = std::clamp(odds->mean.mean, 0.0, 1.0);
        made.buildings.push_back(*std::move(odds));
    }
}

}  // namespace

Result<TwoModels> compare_models(const std::vector<RunRecord>& runs, const std::vector<Measure>& measures,
                                 const EnsembleFolder& fast, std::size_t count) {
    TwoModels made;
    std::map<std::size_t, const RunRecord*> slow;
    for (const RunRecord& run : runs) {
        if (run.complete()) slow[run.run] = &run;
    }
    std::vector<RunRecord> records;
    for (std::size_t run = 0; run < count; ++run) {
        std::error_code error;
        if (!std::filesystem::exists(fast.run_file(run), error)) continue;
        TALUS_ASSIGN(auto record, read_run_record(fast.run_file(run), fast.plan(), run));
        record.complete() ? ++made.fast_complete : ++made.fast_failed;
        if (record.complete()) records.push_back(std::move(record));
    }
    Pairs pairs;
    for (const RunRecord& record : records) {
        const auto twin = slow.find(record.run);
        if (twin == slow.end()) {
            // A place where particles failed is no place of neither: it counts as one of the fast model alone.
            pairs.more.push_back(&record);
            continue;
        }
        pairs.slow.push_back(twin->second);
        pairs.fast.push_back(&record);
    }
    made.pairs = pairs.slow.size();
    for (std::size_t m = 0; m < measures.size(); ++m) {
        auto mean = mean_of(
            pairs, [m](const RunRecord& run) { return m < run.results.size() ? run.results[m] : observe::never; });
        if (!mean) continue;
        mean->key = measures[m].key;
        mean->name = measures[m].name;
        mean->unit = measures[m].unit;
        made.results.push_back(*std::move(mean));
    }
    add_buildings(pairs, made);
    return made;
}

}  // namespace talus::ensemble
