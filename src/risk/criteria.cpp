#include "risk/criteria.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace talus::risk {

const Criteria* criteria_of(params::CriteriaChoice choice) {
    static const Criteria hong_kong{
        .name = "Hong Kong interim risk guidelines",
        .source =
            "ERM-Hong Kong (1998), Landslides and Boulder Falls from Natural Terrain: Interim Risk Guidelines, "
            "GEO Report No. 75; as from memory, not checked against its text",
        .checked = false,
        .existing_individual = 1e-4,
        .new_individual = 1e-5,
        .unacceptable_at_1 = 1e-3,
        .acceptable_at_1 = 1e-5,
        .most_deaths = 1000};
    return choice == params::CriteriaChoice::hong_kong ? &hong_kong : nullptr;
}

Region region_of(const Criteria& criteria, const std::vector<double>& deaths_at_least) {
    Region worst = Region::acceptable;
    for (std::size_t n = 1; n < deaths_at_least.size(); ++n) {
        const double deaths = static_cast<double>(n), frequency = deaths_at_least[n];
        // Rounding of sums over runs is no crossing of a line.
        const auto above = [&](double at_1) { return frequency > at_1 / deaths * (1 + 1e-9); };
        Region here = Region::acceptable;
        if (above(criteria.acceptable_at_1)) here = Region::as_low_as_practicable;
        if (above(criteria.unacceptable_at_1)) here = Region::unacceptable;
        if (deaths > criteria.most_deaths && here != Region::acceptable) here = Region::scrutiny;
        worst = std::max(worst, here);
    }
    return worst;
}

const char* region_text(Region region) {
    static constexpr std::array<const char*, 4> texts = {"broadly acceptable",
                                                         "as low as reasonably practicable (ALARP)", "unacceptable",
                                                         "beyond 1000 deaths: intense scrutiny"};
    return texts.at(static_cast<std::size_t>(region));
}

}  // namespace talus::risk
