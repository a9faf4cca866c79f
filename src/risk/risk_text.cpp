#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report/number_text.hpp"
#include "risk/criteria.hpp"
#include "risk/risk_products.hpp"

namespace talus::risk {
namespace {

using report::plain;

/// Money and numbers of people: without an exponent.
std::string whole(double value) {
    return value >= 1e5 ? report::fixed(value, 0) : plain(value);
}

/// Its end of a sentence, with one full stop.
std::string sourced(const std::string& source, const char* before) {
    if (source.empty()) return "; no source is stated.";
    return before + source + (source.ends_with('.') ? "" : ".");
}

void add_exposures(const scene::Scene& scene, std::vector<std::string>& list) {
    for (const params::ExposureSpec& e : scene.spec.exposures) {
        std::vector<std::string> parts;
        const auto add = [&](const char* what, const std::optional<double>& given, const std::string& attribute,
                             const std::string& unit) {
            if (given) parts.push_back(fmt::format("{} {}{}", what, whole(*given), unit));
            if (!attribute.empty()) parts.push_back(fmt::format("{} from the attribute {}", what, attribute));
        };
        add("value", e.value, e.value_attribute, " " + scene.spec.risk.currency);
        add("persons", e.persons, e.persons_attribute, "");
        add("presence", e.presence, e.presence_attribute, "");
        add("vehicles in a day", e.vehicles_per_day, "", "");
        add("their speed", e.speed, "", " m/s");
        add("persons in each", e.persons_per_vehicle, "", "");
        add("trips in a day of the busiest driver", e.trips_per_day, "", "");
        if (!e.damage_curve.empty()) parts.push_back("damage by " + e.damage_curve);
        if (!e.death_curve.empty()) parts.push_back("death by " + e.death_curve);
        const bool road = e.kind == params::ExposureKind::road;
        const std::string which = road                  ? "the road"
                                  : e.buildings.empty() ? "all buildings"
                                                        : fmt::format("{}", fmt::join(e.buildings, ", "));
        list.push_back(
            fmt::format("Exposure “{}” ({}): {}{}", e.name, which, fmt::join(parts, "; "), sourced(e.source, ". ")));
    }
}

void add_options(const StudyResult& result, std::vector<std::string>& list) {
    for (std::size_t k = 1; k < result.risks.size(); ++k) {
        const params::OptionSpec& o = *result.option(k);
        list.push_back(fmt::format(
            "Option “{}”: cost {} {}, life {} years, interest {} % a year, upkeep {} {} a year{}{}", o.name,
            whole(o.cost), result.scene().spec.risk.currency, plain(o.life), plain(100 * o.interest_rate),
            whole(o.upkeep), result.scene().spec.risk.currency, sourced(o.source, ". "),
            o.removed_buildings.empty() ? ""
                                        : fmt::format(" It removes {}; their persons and value are then out of reach.",
                                                      fmt::join(o.removed_buildings, ", "))));
    }
}

}  // namespace

std::vector<std::string> assumptions_of(const StudyResult& result) {
    const scene::Scene& scene = result.scene();
    const Study& study = *result.study;
    std::vector<std::string> list;
    if (study.per_event) {
        list.emplace_back(
            "The scene states no classes of events with their frequency ([[risk_scenario]]): all numbers are "
            "those of one event, given that it happens.");
    } else {
        for (std::size_t s = 0; s < study.scenarios.size(); ++s) {
            const params::RiskScenarioSpec& of = study.scenarios[s];
            list.push_back(fmt::format("Events of the class “{}” come {} times a year on average, every {} years{}",
                                       of.name, report::significant(study.frequency(s), 3),
                                       report::significant(1 / study.frequency(s), 3), sourced(of.source, ". ")));
        }
        list.emplace_back(
            "Classes of events exclude each other, so their frequencies add; an event of one class is none of "
            "another. A return period is that of the class, not of events of its size or larger.");
        list.emplace_back(
            "Events come independently of each other, and what they destroy is there again before the next one.");
    }
    list.emplace_back("The runs of a class are equally likely samples of it, by the distributions of the factors.");
    add_exposures(scene, list);
    if (result.risks.front().total.has_deaths) {
        list.emplace_back(
            "Each person is present independently of the others and of the time of the event; nobody is warned "
            "or leaves. If people come and go together, events with many deaths are more likely than the F-N "
            "curve says.");
    }
    if (!study.exposures.roads.empty()) {
        list.emplace_back(
            "Vehicles are spread evenly over the day and the road and do not stop before the debris; those that "
            "drive into debris afterwards are not counted. Deaths on a road are a Poisson count.");
    }
    list.emplace_back(
        "A vulnerability curve is read at the peak depth, speed and pressure of a run, which may come at "
        "different times. At a building they are those of the flow in front of it and of the impact on its "
        "walls; on roads and maps those of the cell.");
    if (study.exposures.map_death != nullptr) {
        list.push_back(
            fmt::format("The map of individual risk is that of a person who is always at the place, by the curve {}.",
                        study.exposures.map_death->name));
    }
    add_options(result, list);
    for (const std::string& own : scene.spec.scene.assumptions) list.push_back(own);
    return list;
}

std::vector<std::string> limits_of(const StudyResult& result) {
    std::vector<std::string> list = {
        "Intervals hold what the number of runs leaves open, with 95 %, as of independent draws; a Latin hypercube is "
        "usually "
        "better. They say nothing of wrong frequencies, wrong vulnerability curves or a wrong model, which are usually "
        "the "
        "larger errors.",
        "Where no run reaches a place, n runs exclude with 95 % only probabilities above about 3/n: rarer impacts are "
        "not "
        "seen.",
        "The model leaves out: failures elsewhere on the slope and their triggers, water and floods that follow, "
        "floating wood, "
        "single boulders in flight, damage to what lies within walls, fire, and the failure of buildings onto others.",
        "A measure is as designed on all days: barriers are empty and in repair at every event, unless the scene says "
        "otherwise."};
    for (const OptionOutcome& outcome : result.outcomes) {
        for (const std::string& warning : outcome.verdict.warnings()) {
            list.push_back(fmt::format("{}: {}", outcome.option.empty() ? "As it is" : outcome.option, warning));
        }
    }
    list.emplace_back(
        "This sheet supports a decision and is none. It is to be checked and signed by a licensed engineer, who "
        "answers for frequencies, exposure and vulnerability.");
    return list;
}

}  // namespace talus::risk
