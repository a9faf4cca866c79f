#pragma once

#include <string>
#include <vector>

#include "params/risk_spec.hpp"

/// Published criteria of risk to life.
namespace talus::risk {

struct Criteria {
    std::string name, source;
    bool checked = false;                        ///< against the text of the source
    double existing_individual, new_individual;  ///< per year, of the person most at risk: existing and new slopes
    double unacceptable_at_1, acceptable_at_1;   ///< events in a year with 1 death or more; both fall as 1/N
    double most_deaths;                          ///< beyond which the lines end
};

/// nullptr: none is wanted.
[[nodiscard]] const Criteria* criteria_of(params::CriteriaChoice choice);

enum class Region { acceptable, as_low_as_practicable, unacceptable, scrutiny };

/// Where an F-N curve lies: the worst region that it enters. `deaths_at_least`: as Risk has it.
[[nodiscard]] Region region_of(const Criteria& criteria, const std::vector<double>& deaths_at_least);

/// "broadly acceptable", "as low as reasonably practicable (ALARP)", ...
[[nodiscard]] const char* region_text(Region region);

}  // namespace talus::risk
