#include "risk/risk.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "stats/count_distribution.hpp"
#include "stats/weighted_means.hpp"

namespace talus::risk {
namespace {

/// A number of one run.
using Number = std::function<double(const RunOutcome&)>;

/// The numbers of all runs by class, less those of `base`, if any.
std::vector<stats::WeightedSample> sample(const std::vector<ScenarioOutcome>& scenarios,
                                          const std::vector<ScenarioOutcome>* base, const Number& number) {
    std::vector<stats::WeightedSample> all;
    for (std::size_t s = 0; s < scenarios.size(); ++s) {
        stats::WeightedSample& of = all.emplace_back();
        of.weight = scenarios[s].frequency;
        for (std::size_t r = 0; r < scenarios[s].runs.size(); ++r) {
            const std::optional<RunOutcome>& run = scenarios[s].runs[r];
            if (!run) continue;
            if (base == nullptr) {
                of.values.push_back(number(*run));
            } else if (r < (*base)[s].runs.size() && (*base)[s].runs[r]) {
                of.values.push_back(number(*run) - number(*(*base)[s].runs[r]));
            }
        }
    }
    return all;
}

/// What is estimated of each item, of one set of runs or of the difference of two.
class Estimator {
  public:
    Estimator(const Exposures& exposures, const std::vector<ScenarioOutcome>& scenarios,
              const std::vector<ScenarioOutcome>* base)
        : exposures_(exposures), scenarios_(scenarios), base_(base) {}

    [[nodiscard]] Risk estimate() const {
        Risk risk;
        for (std::size_t b = 0; b < exposures_.buildings.size(); ++b) risk.items.push_back(building(b));
        for (std::size_t r = 0; r < exposures_.roads.size(); ++r) risk.items.push_back(road(r));
        risk.total = total(risk.items);
        for (const ScenarioOutcome& scenario : scenarios_) {
            for (const auto& run : scenario.runs) risk.runs += run ? 1 : 0;
        }
        return risk;
    }

  private:
    [[nodiscard]] stats::Estimate mean_of(const Number& number) const {
        stats::Estimate e = stats::sum_of_means(sample(scenarios_, base_, number));
        if (base_ == nullptr) e.low = std::max(0.0, e.low);
        return e;
    }
    [[nodiscard]] stats::Estimate share_of(const Number& number) const {
        const auto all = sample(scenarios_, base_, number);
        return base_ == nullptr ? stats::sum_of_shares(all) : stats::sum_of_means(all);
    }

    [[nodiscard]] ItemRisk building(std::size_t b) const {
        const ExposedBuilding& e = exposures_.buildings[b];
        ItemRisk item;
        item.name = e.name;
        item.exposure = e.exposure;
        item.impact = share_of([b](const RunOutcome& run) { return run.buildings[b].hit ? 1.0 : 0.0; });
        item.has_loss = e.damage != nullptr;
        item.has_deaths = item.has_individual = e.death != nullptr;
        if (item.has_loss) {
            item.loss = mean_of([b, &e](const RunOutcome& run) { return e.value * run.buildings[b].damage; });
        }
        if (item.has_deaths) {
            item.individual = mean_of([b, &e](const RunOutcome& run) { return e.presence * run.buildings[b].death; });
            item.deaths = {e.persons * item.individual.value, e.persons * item.individual.low,
                           e.persons * item.individual.high};
        }
        return item;
    }

    [[nodiscard]] ItemRisk road(std::size_t r) const {
        const ExposedRoad& e = exposures_.roads[r];
        ItemRisk item;
        item.name = item.exposure = e.name;
        item.road = true;
        item.impact = share_of([r](const RunOutcome& run) { return run.roads[r].hit_length > 0 ? 1.0 : 0.0; });
        item.has_deaths = true;
        item.has_individual = e.has_busiest;
        const auto times = [&](double factor) {
            return mean_of([r, factor](const RunOutcome& run) { return factor * run.roads[r].deadly_length; });
        };
        item.deaths = times(e.persons_per_metre);
        if (item.has_individual) item.individual = times(e.busiest_presence);
        return item;
    }

    /// Of all that is exposed; without exposures of all buildings, of which only impact is known.
    [[nodiscard]] ItemRisk total(const std::vector<ItemRisk>& items) const {
        ItemRisk all;
        all.name = "All";
        const bool some = !exposures_.empty();
        all.impact = share_of([&](const RunOutcome& run) {
            for (std::size_t b = 0; b < run.buildings.size(); ++b) {
                if (run.buildings[b].hit && (!some || !exposures_.buildings[b].exposure.empty())) return 1.0;
            }
            const bool road = std::any_of(run.roads.begin(), run.roads.end(),
                                          [](const RoadOutcome& outcome) { return outcome.hit_length > 0; });
            return road ? 1.0 : 0.0;
        });
        for (const ItemRisk& item : items) {
            all.has_loss = all.has_loss || item.has_loss;
            all.has_deaths = all.has_deaths || item.has_deaths;
            if (item.has_individual && (!all.has_individual || item.individual.value > all.individual.value)) {
                all.individual = item.individual;
                all.has_individual = true;
            }
        }
        all.loss = mean_of([&](const RunOutcome& run) {
            double sum = 0;
            for (std::size_t b = 0; b < run.buildings.size(); ++b) {
                sum += exposures_.buildings[b].value * run.buildings[b].damage;
            }
            return sum;
        });
        all.deaths = mean_of([&](const RunOutcome& run) {
            double sum = 0;
            for (std::size_t b = 0; b < run.buildings.size(); ++b) {
                const ExposedBuilding& e = exposures_.buildings[b];
                sum += e.persons * e.presence * run.buildings[b].death;
            }
            for (std::size_t r = 0; r < run.roads.size(); ++r) {
                sum += exposures_.roads[r].persons_per_metre * run.roads[r].deadly_length;
            }
            return sum;
        });
        return all;
    }

    const Exposures& exposures_;
    const std::vector<ScenarioOutcome>& scenarios_;
    const std::vector<ScenarioOutcome>* base_;
};

/// Probability of N deaths or more in one run: everybody is there, or not, independently of the others.
std::vector<double> deaths_of(const Exposures& exposures, const RunOutcome& run) {
    stats::CountDistribution deaths;
    for (std::size_t b = 0; b < run.buildings.size(); ++b) {
        const ExposedBuilding& e = exposures.buildings[b];
        const double each = e.presence * run.buildings[b].death, whole = std::floor(e.persons);
        deaths.add_binomial(static_cast<std::size_t>(whole), each);
        if (e.persons > whole) deaths.add_binomial(1, (e.persons - whole) * each);
    }
    for (std::size_t r = 0; r < run.roads.size(); ++r) {
        deaths.add_poisson(exposures.roads[r].persons_per_metre * run.roads[r].deadly_length);
    }
    return deaths.at_least();
}

std::vector<double> societal(const Exposures& exposures, const std::vector<ScenarioOutcome>& scenarios) {
    std::vector<double> sum;
    for (const ScenarioOutcome& scenario : scenarios) {
        double complete = 0;
        for (const auto& run : scenario.runs) complete += run ? 1 : 0;
        for (const auto& run : scenario.runs) {
            if (!run) continue;
            const std::vector<double> share = deaths_of(exposures, *run);
            if (sum.size() < share.size()) sum.resize(share.size(), 0);
            for (std::size_t n = 0; n < share.size(); ++n) sum[n] += scenario.frequency / complete * share[n];
        }
    }
    return sum;
}

}  // namespace

Risk evaluate(const Exposures& exposures, const std::vector<ScenarioOutcome>& scenarios) {
    Risk risk = Estimator(exposures, scenarios, nullptr).estimate();
    risk.deaths_at_least = societal(exposures, scenarios);
    return risk;
}

Risk difference(const Exposures& exposures, const std::vector<ScenarioOutcome>& changed,
                const std::vector<ScenarioOutcome>& base) {
    return Estimator(exposures, changed, &base).estimate();
}

double cost_per_year(const params::OptionSpec& option) {
    const double i = option.interest_rate;
    const double share = i > 0 ? i / -std::expm1(-option.life * std::log1p(i)) : 1 / option.life;
    return option.cost * share + option.upkeep;
}

double annual_probability(double events_per_year) {
    return -std::expm1(-events_per_year);
}

stats::Estimate annual_probability(const stats::Estimate& events_per_year) {
    return {annual_probability(events_per_year.value), annual_probability(events_per_year.low),
            annual_probability(events_per_year.high)};
}

}  // namespace talus::risk
