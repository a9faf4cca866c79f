#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "params/declaration.hpp"

namespace talus::params {
namespace {

std::optional<Violation> incomplete(const TriggerSpec& trigger) {
    if (trigger.volume_limit && trigger.release.empty()) {
        return Violation{"volume_limit_m3", ": needs release, whose volume a message may set"};
    }
    if (trigger.discharge_limit && trigger.inflow.empty()) {
        return Violation{"discharge_limit_m3ps", ": needs inflow, which a gauge may feed"};
    }
    if (trigger.start_discharge > 0 && !trigger.discharge_limit) {
        return Violation{"start_discharge_m3ps", ": needs discharge_limit_m3ps"};
    }
    return {};
}

std::optional<Violation> not_measured(const AlarmSpec& alarm) {
    if (alarm.x.has_value() != alarm.y.has_value()) return Violation{"y_m", ": x_m and y_m go together"};
    if ((alarm.distance || alarm.lead_time) && alarm.x) {
        return Violation{alarm.distance ? "distance_m" : "lead_time_s", ": needs structure or chainage_m"};
    }
    if ((alarm.impact_pressure || alarm.dynamic_pressure) && alarm.structure.empty()) {
        return Violation{alarm.impact_pressure ? "impact_pressure_Pa" : "dynamic_pressure_Pa", ": needs structure"};
    }
    if (alarm.depth && alarm.chainage) return Violation{"depth_m", ": needs structure, or x_m and y_m"};
    return {};
}

}  // namespace

Section declare_trigger() {
    Declaration<TriggerSpec> s("trigger",
                               "A run of the live twin that starts when a program or a gauge says so "
                               "(docs/triggers.md); any number. A release "
                               "or an inflow that only other triggers name is left out of it.",
                               &SceneSpec::triggers);
    s.text("name", &TriggerSpec::name, "", "By which a message names it.").required = true;
    s.text("release", &TriggerSpec::release, "none", "Name of the release whose values a message may set.");
    s.text("inflow", &TriggerSpec::inflow, "none", "Name of the inflow that a gauge may feed.");
    s.optional_key("volume_limit_m3", "m3", &TriggerSpec::volume_limit, above_to(0, 1e9), "a message cannot set it",
                   "Largest volume of the release that a message may set.");
    s.optional_key("pore_pressure_ratio_limit", "", &TriggerSpec::pore_pressure_ratio_limit, between(0, 1),
                   "a message cannot set it",
                   "Largest pore pressure ratio that a message may set, of the release, or of all debris without one.");
    s.optional_key("discharge_limit_m3ps", "m3/s", &TriggerSpec::discharge_limit, above_to(0, 1e7),
                   "a message cannot set it", "Largest discharge that a gauge may report; larger values are refused.");
    s.key("start_discharge_m3ps", "m3/s", &TriggerSpec::start_discharge, between(0, 1e7),
          "A gauge above this discharge starts the run.")
        .below_key("discharge_limit_m3ps");
    s.key("hold_time_s", "s", &TriggerSpec::hold_time, between(1, 1e6),
          "Simulated time for which the last value of a gauge holds; after it the inflow ends.");
    s.rule([](const TriggerSpec& trigger, const SceneSpec& scene, double) {
        const auto twice = name_twice(trigger, scene.triggers);
        return twice ? twice : incomplete(trigger);
    });
    return s.take();
}

Section declare_alarm() {
    Declaration<AlarmSpec> s("alarm",
                             "A rule for which every live run is watched (docs/triggers.md); any number. It has one "
                             "place and one condition, and is raised once in a run.",
                             &SceneSpec::alarms);
    s.text("name", &AlarmSpec::name, "", "By which messages name it.").required = true;
    s.text("structure", &AlarmSpec::structure, "none", "Place: the building or barrier of that name.");
    s.optional_key("chainage_m", "m", &AlarmSpec::chainage, between(0, 1e6), "none",
                   "Place: horizontal distance along the flow path from its first point.");
    s.optional_key("x_m", "m", &AlarmSpec::x, between(-1e9, 1e9), "none",
                   "Place: east coordinate in the terrain's reference system.");
    s.optional_key("y_m", "m", &AlarmSpec::y, between(-1e9, 1e9), "none",
                   "Place: north coordinate in the terrain's reference system.");
    s.optional_key("distance_m", "m", &AlarmSpec::distance, between(0, 1e6), "none",
                   "Condition: the front is within this distance of the place along the flow path; 0: it is there.");
    s.optional_key("lead_time_s", "s", &AlarmSpec::lead_time, above_to(0, 1e6), "none",
                   "Condition: at its present velocity the front is at the place within this time.");
    s.optional_key("impact_pressure_Pa", "Pa", &AlarmSpec::impact_pressure, above_to(0, 1e12), "none",
                   "Condition: the peak impact pressure on the structure is at least this.");
    s.optional_key("dynamic_pressure_Pa", "Pa", &AlarmSpec::dynamic_pressure, above_to(0, 1e12), "none",
                   "Condition: the peak dynamic pressure of the flow in front of the structure is at least this.");
    s.optional_key("depth_m", "m", &AlarmSpec::depth, above_to(0, 1e4), "none",
                   "Condition: debris at the place, or in front of the structure, is at least this deep.");
    s.text("message", &AlarmSpec::message, "none", "Sent and shown with it.");
    s.exactly_one_of({"structure", "chainage_m", "x_m"});
    s.exactly_one_of({"distance_m", "lead_time_s", "impact_pressure_Pa", "dynamic_pressure_Pa", "depth_m"});
    s.rule([](const AlarmSpec& alarm, const SceneSpec& scene, double) {
        const auto twice = name_twice(alarm, scene.alarms);
        return twice ? twice : not_measured(alarm);
    });
    return s.take();
}

}  // namespace talus::params
