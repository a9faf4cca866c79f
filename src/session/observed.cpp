#include "session/observed.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "ensemble/predict.hpp"
#include "messages/messages.hpp"
#include "twin/live_run.hpp"
#include "twin/results.hpp"
#include "twin/setup.hpp"

namespace talus::session {
namespace {

messages::Observed observed_in(const scene::Scene& scene, const run::RunResult& result,
                               const std::vector<twin::TableSetup>& entries) {
    std::vector<std::string> ids;
    for (const std::string& section : twin::sections_of(twin::TableKind::observation)) {
        for (const twin::TableSetup& entry : entries) {
            if (entry.body->section == section) ids.push_back(entry.id);
        }
    }
    const std::vector<ensemble::ObservedValue> observed = ensemble::observed_values(scene);
    const std::vector<double> predicted = ensemble::predicted_values(scene, result.observation);
    std::vector<messages::ObservedRow> rows;
    rows.reserve(observed.size());
    for (std::size_t k = 0; k < observed.size(); ++k) {
        const ensemble::ObservedValue& o = observed[k];
        const bool reached = std::isfinite(predicted[k]) && !(o.unreached < 0 && predicted[k] < 0);
        const double deviation = deviation_of(o, reached ? predicted[k] : o.unreached);
        rows.push_back({.id = k < ids.size() ? std::optional(ids[k]) : std::nullopt,
                        .name = o.name,
                        .unit = o.unit,
                        .observed = o.value,
                        .uncertainty = o.uncertainty,
                        .is = o.is(),
                        .computed = reached ? std::optional(predicted[k]) : std::nullopt,
                        .deviation = deviation});
    }
    return {.time_s = result.simulated_time, .rows = std::move(rows)};
}

}  // namespace

Rest observed(Scenarios& all, int index, const Arguments& /*arguments*/) {
    const twin::Scenario& scenario = all.at(index);
    return [outcome = twin::outcome_of(scenario), entries = scenario.run().setup().observations] {
        const auto& [scene, result] = outcome;
        return reply(observed_in(scene, result, entries));
    };
}

}  // namespace talus::session
