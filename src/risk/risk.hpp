#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "risk/exposures.hpp"
#include "risk/outcome.hpp"
#include "stats/sensitivity.hpp"

/// Risk: what happens to what is at risk, times how often it happens.
namespace talus::risk {

/// Of a building, a road, or all together. Each is a sum over the classes of events of frequency times the mean over
/// the runs, with its interval of 95 %.
struct ItemRisk {
    std::string name, exposure;
    bool road = false;
    stats::Estimate impact;      ///< events in a year that reach it
    stats::Estimate loss;        ///< in the scene's currency, per year
    stats::Estimate deaths;      ///< expected in a year
    stats::Estimate individual;  ///< death in a year of the person who is there most; of all together: the highest
    bool has_loss = false, has_deaths = false, has_individual = false;
};

struct Risk {
    std::vector<ItemRisk> items;  ///< buildings, then roads
    ItemRisk total;
    std::vector<double> deaths_at_least;  ///< entry N: events in a year with N deaths or more; entry 0 is of all events
    std::size_t runs = 0;                 ///< complete ones, of all classes
};

/// Every class has at least two complete runs.
[[nodiscard]] Risk evaluate(const Exposures& exposures, const std::vector<ScenarioOutcome>& scenarios);

/// `changed` less `base`, of the runs that both have, pair by pair: where both have the same draws, the interval is
/// that of the differences. Without deaths_at_least. Highest individual risk: of the items, not of pairs.
[[nodiscard]] Risk difference(const Exposures& exposures, const std::vector<ScenarioOutcome>& changed,
                              const std::vector<ScenarioOutcome>& base);

/// Cost of a year: that of building it spread over its life as an annuity, and its upkeep.
[[nodiscard]] double cost_per_year(const params::OptionSpec& option);

/// Probability of at least one event in a year, of events that come independently so often.
[[nodiscard]] double annual_probability(double events_per_year);
[[nodiscard]] stats::Estimate annual_probability(const stats::Estimate& events_per_year);

}  // namespace talus::risk
