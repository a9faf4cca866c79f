#include "twin/trigger.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/hydrograph.hpp"
#include "terrain/inflow.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
#include "twin/scenario_parts.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

constexpr std::size_t most_rows = 10'000;  // every step integrates them

const params::InflowSample& peak_of(const std::vector<params::InflowSample>& rows) {
    return *std::max_element(rows.begin(), rows.end(),
                             [](const auto& a, const auto& b) { return a.discharge < b.discharge; });
}

/// A gauge measures discharge alone.
params::InflowSample rated_row(const std::vector<params::InflowSample>& rated, double time, double discharge) {
    const params::InflowSample& peak = peak_of(rated);
    return {time, discharge, peak.velocity * std::pow(discharge / peak.discharge, 0.4), peak.density};
}

Result<params::TriggerSpec> trigger_of(const json& action, const Setup& setup) {
    TALUS_ASSIGN(const auto name, read_text(action, "trigger"));
    std::vector<std::string> names;
    for (const params::TriggerSpec& trigger : triggers_of(setup)) {
        if (name && trigger.name == *name) return trigger;
        names.push_back(trigger.name);
    }
    if (!name) return Error{"trigger: missing; it must be the name of a trigger of the scene"};
    const std::string nearest = params::nearest_word(*name, names);
    return Error{fmt::format("trigger = {}: there is no such trigger; {}", shown(json(*name)),
                             nearest.empty() ? "the scene has none" : "nearest name: " + nearest)};
}

/// A value within its limit; empty: the message does not have it.
Result<std::optional<double>> limited(const json& values, const char* key, const char* unit, bool above_0,
                                      const std::optional<double>& limit, const params::TriggerSpec& trigger) {
    if (!values.contains(key)) return std::optional<double>();
    if (!limit) {
        return Error{
            fmt::format("{}: trigger \"{}\" does not take it; the scene gives it no limit", key, trigger.name)};
    }
    TALUS_ASSIGN(const auto value,
                 read_number(values, key, {.low = 0, .high = *limit, .low_included = !above_0}, unit));
    if (!value) return Error{fmt::format("{} = null: must be a number", key)};
    return value;
}

struct TriggerValues {
    std::optional<double> volume, pore_pressure_ratio, discharge;
};

Result<TriggerValues> read_trigger_values(const json& action, const params::TriggerSpec& trigger) {
    const json values = action.value("values", json::object());
    if (!values.is_object()) return Error{fmt::format("values = {}: must be an object", shown(values))};
    TALUS_TRY(check_keys(values, {"volume_m3", "pore_pressure_ratio", "discharge_m3ps"}));
    TriggerValues read;
    TALUS_ASSIGN(read.volume, limited(values, "volume_m3", "m3", true, trigger.volume_limit, trigger));
    TALUS_ASSIGN(read.pore_pressure_ratio,
                 limited(values, "pore_pressure_ratio", "", false, trigger.pore_pressure_ratio_limit, trigger));
    TALUS_ASSIGN(read.discharge, limited(values, "discharge_m3ps", "m3/s", true, trigger.discharge_limit, trigger));
    return read;
}

/// Removes what only other triggers name.
template <class Entry>
void keep_own(std::vector<Entry>& entries, const std::vector<params::TriggerSpec>& triggers,
              const params::TriggerSpec& own, std::string params::TriggerSpec::*names) {
    std::erase_if(entries, [&](const Entry& entry) {
        const std::string& name = entry.body->name;
        return own.*names != name && std::any_of(triggers.begin(), triggers.end(),
                                                 [&](const params::TriggerSpec& t) { return t.*names == name; });
    });
}

template <class Entry>
Result<Entry*> own_entry(std::vector<Entry>& entries, const std::string& name, const char* what) {
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.body->name == name; });
    if (found == entries.end()) return Error{fmt::format("the setup has no {} \"{}\"", what, name)};
    return &*found;
}

Status set_release(const TriggerValues& values, ReleaseSetup& setup, const ActionContext& context) {
    terrain::Release release = *setup.body;
    if (values.volume) {
        const double factor = *values.volume / release.volume;
        for (terrain::ReleasePatch& patch : release.patches) patch.thickness *= factor;
        if (release.spec.thickness) *release.spec.thickness *= factor;
        if (release.spec.volume) release.spec.volume = *values.volume;
        release.volume = release_volume(context.scene.terrain, release);
        const double particle = std::pow(context.particle_spacing, 3);
        if (release.volume < particle) {
            return Error{
                fmt::format("volume_m3 = {:.6g}: must be at least one particle, {:.3g} m3", *values.volume, particle)};
        }
    }
    if (values.pore_pressure_ratio) {  // in place of water that rises
        release.spec.pore_pressure_ratio = values.pore_pressure_ratio;
        release.spec.pore_pressure_hydrograph.clear();
        release.water.clear();
    }
    setup.body = std::make_shared<const terrain::Release>(std::move(release));
    setup.as_in_scene = false;
    return {};
}

Status check_amount(const Setup& setup, const InflowSetup* existing, const terrain::Inflow& inflow,
                    const ActionContext& context) {
    const params::SolverSpec& solver = context.scene.spec.solver;
    TALUS_TRY(scene::check_hydrograph(inflow, solver, "discharge_m3ps"));
    const double particles = particles_in_all(setup, existing, inflow, context.particle_spacing);
    const int limit = std::min(solver.particle_limit, max_live_particles);
    if (particles <= limit) return {};
    return Error{fmt::format("discharge_m3ps: held for its time it would make {:.0f} particles in all; there may be {}",
                             particles, limit)};
}

Status set_inflow(double discharge, double hold, InflowSetup& setup, const Setup& all, const ActionContext& context) {
    terrain::Inflow inflow = *setup.body;
    inflow.hydrograph = {rated_row(setup.body->hydrograph, 0, discharge),
                         rated_row(setup.body->hydrograph, hold, discharge),
                         rated_row(setup.body->hydrograph, hold + gauge_rise_time, 0)};
    TALUS_TRY(check_amount(all, &setup, inflow, context));
    setup.body = std::make_shared<const terrain::Inflow>(std::move(inflow));
    setup.as_in_scene = false;
    return {};
}

std::string told(const TriggerValues& values) {
    std::string text;
    if (values.volume) text += fmt::format(", volume {:.6g} m3", *values.volume);
    if (values.pore_pressure_ratio) text += fmt::format(", pore pressure ratio {:.4g}", *values.pore_pressure_ratio);
    if (values.discharge) text += fmt::format(", gauge {:.6g} m3/s", *values.discharge);
    return text;
}

}  // namespace

std::vector<params::InflowSample> with_reading(const std::vector<params::InflowSample>& hydrograph,
                                               const std::vector<params::InflowSample>& rated, double time,
                                               double discharge, double hold) {
    std::vector<params::InflowSample> rows;
    for (const params::InflowSample& row : hydrograph) {
        if (row.time < time) rows.push_back(row);
    }
    const params::InflowSample& last = hydrograph.back();
    const auto value = [&](double params::InflowSample::*column) {
        if (time <= hydrograph.front().time) return hydrograph.front().*column;
        const auto after = std::find_if(hydrograph.begin(), hydrograph.end(),
                                        [&](const params::InflowSample& row) { return row.time >= time; });
        if (after == hydrograph.end()) return last.*column;
        const params::InflowSample &a = *(after - 1), &b = *after;
        return a.*column + (b.*column - a.*column) * (time - a.time) / (b.time - a.time);
    };
    rows.push_back({time, value(&params::InflowSample::discharge), value(&params::InflowSample::velocity),
                    value(&params::InflowSample::density)});
    rows.push_back(rated_row(rated, time + gauge_rise_time, discharge));
    rows.push_back(rated_row(rated, time + gauge_rise_time + hold, discharge));
    rows.push_back(rated_row(rated, time + 2 * gauge_rise_time + hold, 0));
    return rows;
}

Result<Edit> read_trigger(const json& action, const Setup& setup, const ActionContext& context) {
    TALUS_TRY(check_keys(action, {"action", "trigger", "source", "received_at", "reason", "values"}));
    if (context.begun) return Error{"trigger: starts a run at time 0, and this one has begun"};
    TALUS_ASSIGN(const params::TriggerSpec trigger, trigger_of(action, setup));
    TALUS_ASSIGN(const TriggerValues values, read_trigger_values(action, trigger));
    Edit edit{setup, "", ""};
    const std::vector<params::TriggerSpec> all = triggers_of(setup);
    keep_own(edit.setup.releases, all, trigger, &params::TriggerSpec::release);
    keep_own(edit.setup.inflows, all, trigger, &params::TriggerSpec::inflow);
    if (edit.setup.releases.empty() && edit.setup.inflows.empty()) {
        return Error{
            fmt::format("trigger \"{}\": its run has no debris; it must name a release or an inflow", trigger.name)};
    }
    if (!trigger.release.empty() && (values.volume || values.pore_pressure_ratio)) {
        TALUS_ASSIGN(ReleaseSetup * release, own_entry(edit.setup.releases, trigger.release, "release"));
        TALUS_TRY(set_release(values, *release, context));
    } else if (values.pore_pressure_ratio) {
        edit.setup.material.pore_pressure_ratio = *values.pore_pressure_ratio;
    }
    if (values.discharge) {
        TALUS_ASSIGN(InflowSetup * inflow, own_entry(edit.setup.inflows, trigger.inflow, "inflow"));
        TALUS_TRY(set_inflow(*values.discharge, trigger.hold_time, *inflow, edit.setup, context));
    }
    TALUS_ASSIGN(const auto reason, read_text(action, "reason", 200));
    edit.sentence =
        fmt::format("started by trigger \"{}\"{}{}", trigger.name, told(values), reason ? ": " + *reason : "");
    return edit;
}

const json* started_by(const Scenario& scenario) {
    const std::vector<JournalEntry>& entries = scenario.parts().entries;
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [](const JournalEntry& entry) { return entry.action["action"] == "trigger"; });
    return found == entries.end() ? nullptr : &found->action;
}

Result<GaugeReading> read_gauge(const json& action, const Setup& setup, const Setup& begun_with,
                                const ActionContext& context, double now, double last) {
    TALUS_TRY(check_keys(action, {"action", "trigger", "source", "received_at", "time_s", "discharge_m3ps"}));
    TALUS_ASSIGN(const params::TriggerSpec trigger, trigger_of(action, setup));
    TALUS_ASSIGN(const auto discharge,
                 limited(action, "discharge_m3ps", "m3/s", false, trigger.discharge_limit, trigger));
    if (!discharge) return Error{"discharge_m3ps: missing; it must be a number (m3/s)"};
    TALUS_ASSIGN(const auto time, read_number(action, "time_s", {.low = 0, .high = 1e7}, "s"));
    if (!time) return Error{"time_s: missing; it must be a number (s)"};
    if (*time <= last) {
        return Error{fmt::format("the value of {:.1f} s is not later than the one before, of {:.1f} s", *time, last)};
    }
    const auto entry = std::find_if(setup.inflows.begin(), setup.inflows.end(), [&](const InflowSetup& inflow) {
        return inflow.scene_index >= 0 &&
               context.scene.inflows[static_cast<std::size_t>(inflow.scene_index)].name == trigger.inflow;
    });
    const InflowSetup* begun = entry == setup.inflows.end() ? nullptr : find_id(begun_with.inflows, entry->id);
    if (begun == nullptr || !same_shape(begun->body, entry->body)) {
        return Error{
            fmt::format("inflow \"{}\" is not that of this run any more; somebody has changed it", trigger.inflow)};
    }
    const double from = std::max(*time, now);
    terrain::Inflow inflow = *entry->body;
    const terrain::Inflow& rated = context.scene.inflows[static_cast<std::size_t>(entry->scene_index)];
    inflow.hydrograph = with_reading(inflow.hydrograph, rated.hydrograph, from, *discharge, trigger.hold_time);
    if (inflow.hydrograph.size() > most_rows) {
        return Error{fmt::format("the hydrograph has {} rows, the most there can be", most_rows)};
    }
    TALUS_TRY(check_amount(setup, &*entry, inflow, context));
    GaugeReading reading{entry->id, std::make_shared<const terrain::Inflow>(std::move(inflow)), ""};
    reading.sentence = fmt::format("gauge of \"{}\": {:.6g} m3/s at {:.1f} s", trigger.name, *discharge, *time);
    if (*time < now) reading.sentence += fmt::format(", late: from {:.1f} s on", now);
    return reading;
}

}  // namespace talus::twin
