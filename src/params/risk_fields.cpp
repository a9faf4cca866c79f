// Options, and what is at risk.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "params/declaration.hpp"

namespace talus::params {
namespace {

/// `prefix`: of the name of a section that has none of its own, by its number.
template <class Spec>
std::optional<Violation> names_none(const std::string& key, const std::vector<std::string>& names,
                                    const std::vector<Spec>& all, const char* prefix) {
    std::vector<std::string> known;
    for (std::size_t k = 0; k < all.size(); ++k) {
        known.push_back(all[k].name.empty() ? fmt::format("{} {}", prefix, k + 1) : all[k].name);
    }
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        return Violation{key, fmt::format(": there is no {} \"{}\"; {}s of the scene: {}", prefix, name, prefix,
                                          known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")))};
    }
    return {};
}

/// The keys that one kind of exposure has and the other lacks.
std::optional<Violation> of_the_other_kind(const ExposureSpec& e) {
    const bool road = e.kind == ExposureKind::road;
    const auto given = [&](bool is_given, const char* key) -> std::optional<Violation> {
        if (!is_given) return {};
        return Violation{key, fmt::format(": is not for kind = \"{}\"", road ? "road" : "buildings")};
    };
    std::optional<Violation> wrong;
    const auto check = [&](bool is_given, const char* key) {
        if (!wrong) wrong = given(is_given, key);
    };
    if (road) {
        check(!e.buildings.empty(), "buildings");
        check(e.value.has_value(), "value");
        check(!e.value_attribute.empty(), "value_attribute");
        check(e.persons.has_value(), "persons");
        check(!e.persons_attribute.empty(), "persons_attribute");
        check(e.presence.has_value(), "presence");
        check(!e.presence_attribute.empty(), "presence_attribute");
        check(!e.damage_curve.empty(), "damage_curve");
    } else {
        check(!e.line.empty(), "line_m");
        check(!e.file.empty(), "file");
        check(e.vehicles_per_day.has_value(), "vehicles_per_day");
        check(e.speed.has_value(), "speed_mps");
        check(e.persons_per_vehicle.has_value(), "persons_per_vehicle");
        check(e.trips_per_day.has_value(), "trips_per_day");
    }
    return wrong;
}

/// Nothing is computed from a value that nobody gave.
std::optional<Violation> incomplete(const ExposureSpec& e) {
    const auto missing = [](const char* key, const char* what) {
        return Violation{key, fmt::format(" is missing; {}", what)};
    };
    if (e.kind == ExposureKind::road) {
        if (e.line.empty() && e.file.empty()) return missing("line_m", "a road needs line_m or file");
        if (!e.line.empty() && !e.file.empty()) return Violation{"file", ": is refused beside line_m"};
        if (e.line.size() == 1) return Violation{"line_m", " has 1 place; a line needs at least two"};
        if (!e.vehicles_per_day) return missing("vehicles_per_day", "a road needs its traffic, both directions");
        if (!e.speed) return missing("speed_mps", "a road needs the mean speed of its vehicles");
        if (!e.persons_per_vehicle) return missing("persons_per_vehicle", "a road needs the persons in a vehicle");
        if (e.death_curve.empty()) return missing("death_curve", "a road needs the name of a vulnerability curve");
        return {};
    }
    const bool worth = e.value || !e.value_attribute.empty();
    const bool lived_in = e.persons || !e.persons_attribute.empty();
    const bool times = e.presence || !e.presence_attribute.empty();
    if (!worth && !lived_in) return missing("value", "buildings need value, persons, or both");
    if (worth && e.damage_curve.empty())
        return missing("damage_curve", "value needs the name of a vulnerability curve");
    if (!worth && !e.damage_curve.empty()) return Violation{"damage_curve", ": needs value or value_attribute"};
    if (lived_in && !times) return missing("presence", "persons need the share of the time at which they are there");
    if (times && !lived_in) return Violation{"presence", ": needs persons or persons_attribute"};
    if (lived_in && e.death_curve.empty())
        return missing("death_curve", "persons need the name of a vulnerability curve");
    if (!lived_in && !e.death_curve.empty()) return Violation{"death_curve", ": needs persons or persons_attribute"};
    return {};
}

}  // namespace

Section declare_option() {
    Declaration<OptionSpec> s(
        "option",
        "Measures that are built, or not, together (docs/risk.md); any number. Barriers and zones that some option "
        "names are in force only where scene.option is an option that names them.",
        &SceneSpec::options);
    s.text("name", &OptionSpec::name, "", "Name in reports, and of --set scene.option=NAME.").required = true;
    s.key("barriers", "", &OptionSpec::barriers, anything(), "Names of the [[barrier]] that it builds.");
    s.key("zones", "", &OptionSpec::zones, anything(), "Names of the [[zone]] that it makes, such as a forest.");
    s.key("removed_buildings", "", &OptionSpec::removed_buildings, anything(),
          "Names of the buildings that it removes; their persons and value are then elsewhere.");
    s.key("cost", "currency", &OptionSpec::cost, at_least(0), "Cost of building it, in risk.currency.").required = true;
    s.key("life_years", "years", &OptionSpec::life, above_to(0, 1000), "Years that it serves.").required = true;
    s.key("interest_rate", "1/year", &OptionSpec::interest_rate, between(0, 1),
          "Interest, with which the cost is spread evenly over its life; 0.03: 3 % a year.")
        .required = true;
    s.key("upkeep_per_year", "currency/year", &OptionSpec::upkeep, at_least(0), "Cost of its upkeep in a year.")
        .required = true;
    s.text("notes", &OptionSpec::notes, "none", "What it is, printed in the report.");
    s.text("source", &OptionSpec::source, "none", "Where its cost comes from, printed in the report.");
    s.rule([](const OptionSpec& option, const SceneSpec& scene, double) -> std::optional<Violation> {
        if (auto twice = name_twice(option, scene.options)) return twice;
        if (auto none = names_none("barriers", option.barriers, scene.barriers, "barrier")) return none;
        if (auto none = names_none("zones", option.zones, scene.zones, "zone")) return none;
        if (!option.barriers.empty() || !option.zones.empty() || !option.removed_buildings.empty()) return {};
        return Violation{"barriers", " is missing; an option needs barriers, zones or removed_buildings"};
    });
    return s.take();
}

Section declare_risk() {
    Declaration<RiskSpec> s("risk", "How risk is stated (docs/risk.md).", &SceneSpec::risk);
    s.text("currency", &RiskSpec::currency, "values and costs cannot be given",
           "Currency of all values and costs of the scene, such as \"HKD\".");
    s.path("curves", &RiskSpec::curves, "those of the program",
           "File with more vulnerability curves (TOML, as docs/risk.md describes).");
    s.text("map_death_curve", &RiskSpec::map_death_curve, "no map",
           "Name of the vulnerability curve of the map of individual risk: of a person who is always at that place.");
    s.choice("criteria", &RiskSpec::criteria, {"hong_kong", "none"},
             "Published criteria that risk of death is compared with; hong_kong: GEO Report 75.");
    s.rule([](const RiskSpec& risk, const SceneSpec& scene, double) -> std::optional<Violation> {
        const bool costs = !scene.options.empty() ||
                           std::any_of(scene.exposures.begin(), scene.exposures.end(),
                                       [](const ExposureSpec& e) { return e.value || !e.value_attribute.empty(); });
        if (!costs || !risk.currency.empty()) return {};
        return Violation{"currency", " is missing; [[option]] and the value of an [[exposure]] need it"};
    });
    return s.take();
}

Section declare_risk_scenario() {
    Declaration<RiskScenarioSpec> s(
        "risk_scenario",
        "A class of events, such as the small and the large slide, with how often it comes; the runs of an ensemble "
        "are samples of it. Classes exclude each other: their frequencies add.",
        &SceneSpec::risk_scenarios);
    s.text("name", &RiskScenarioSpec::name, "", "Name in reports and of its folder.").required = true;
    s.optional_key("annual_frequency", "1/year", &RiskScenarioSpec::annual_frequency, above_to(0, 100),
                   "return_period_years is given", "Events of this class in a year, on average.");
    s.optional_key("return_period_years", "years", &RiskScenarioSpec::return_period, between(0.01, 1e7),
                   "annual_frequency is given", "Years between events of this class, on average.");
    s.key("set", "", &RiskScenarioSpec::set, anything(),
          "What the scene has in it, each as on the command line: \"release.volume_m3=2000\".");
    s.text("source", &RiskScenarioSpec::source, "none", "Where its frequency comes from, printed in the report.");
    s.exactly_one_of({"annual_frequency", "return_period_years"});
    s.rule([](const RiskScenarioSpec& scenario, const SceneSpec& scene, double) {
        return name_twice(scenario, scene.risk_scenarios);
    });
    return s.take();
}

Section declare_exposure() {
    Declaration<ExposureSpec> s("exposure", "What debris may meet: buildings, or a road with traffic; any number.",
                                &SceneSpec::exposures);
    s.text("name", &ExposureSpec::name, "", "Name in reports.").required = true;
    s.choice("kind", &ExposureSpec::kind, {"buildings", "road"}, "What it is.");
    s.key("buildings", "", &ExposureSpec::buildings, anything(),
          "Names of the buildings; none are all of the scene. A building may be in one exposure only.");
    s.optional_key("value", "currency", &ExposureSpec::value, at_least(0), "no loss is computed",
                   "Value of each building with its contents, in risk.currency.");
    s.text("value_attribute", &ExposureSpec::value_attribute, "value", "Attribute of buildings.file that holds it.");
    s.optional_key("persons", "", &ExposureSpec::persons, between(0, 1e5), "no risk of death is computed",
                   "Persons who belong to each building.");
    s.text("persons_attribute", &ExposureSpec::persons_attribute, "persons",
           "Attribute of buildings.file that holds them.");
    s.optional_key("presence", "", &ExposureSpec::presence, between(0, 1), "persons are not given",
                   "Share of the time at which each of them is there, 0 to 1.");
    s.text("presence_attribute", &ExposureSpec::presence_attribute, "presence",
           "Attribute of buildings.file that holds it, 0 to 1.");
    s.key("line_m", "m", &ExposureSpec::line, anything(),
          "Line of a road in plan, in the terrain's reference system; at least two places.");
    s.path("file", &ExposureSpec::file, "line_m is given", "The same in a file: GeoJSON, GeoPackage, Shapefile.");
    s.text("layer", &ExposureSpec::layer, "the only layer", "Layer of the file.");
    s.optional_key("vehicles_per_day", "1/day", &ExposureSpec::vehicles_per_day, between(0, 1e6), "buildings",
                   "Vehicles on the road in a day, both directions.");
    s.optional_key("speed_mps", "m/s", &ExposureSpec::speed, above_to(0, 100), "buildings",
                   "Mean speed of the vehicles.");
    s.optional_key("persons_per_vehicle", "", &ExposureSpec::persons_per_vehicle, between(0, 500), "buildings",
                   "Persons in a vehicle, on average.");
    s.optional_key("trips_per_day", "1/day", &ExposureSpec::trips_per_day, between(0, 1000),
                   "no individual risk is computed", "Trips in a day of the person who is on the road most.");
    s.text("death_curve", &ExposureSpec::death_curve, "no risk of death is computed",
           "Name of the vulnerability curve for the probability that a person there dies.");
    s.text("damage_curve", &ExposureSpec::damage_curve, "no loss is computed",
           "Name of the vulnerability curve for the share of the value that is lost.");
    s.text("source", &ExposureSpec::source, "none", "Where its numbers come from, printed in the report.");
    s.at_most_one_of({"value", "value_attribute"});
    s.at_most_one_of({"persons", "persons_attribute"});
    s.at_most_one_of({"presence", "presence_attribute"});
    s.rule([](const ExposureSpec& exposure, const SceneSpec& scene, double) -> std::optional<Violation> {
        if (auto twice = name_twice(exposure, scene.exposures)) return twice;
        if (auto other = of_the_other_kind(exposure)) return other;
        return incomplete(exposure);
    });
    return s.take();
}

}  // namespace talus::params
