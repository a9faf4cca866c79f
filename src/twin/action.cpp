#include "twin/action.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/viscosity_limit.hpp"
#include "terrain/barrier.hpp"
#include "twin/json_keys.hpp"
#include "twin/put.hpp"
#include "twin/section_values.hpp"

namespace talus::twin {
namespace {

using nlohmann::json;

/// Reads one action: `edit` starts as the current setup and is changed.
class ActionReader {
  public:
    ActionReader(const json& action, NextNumbers& next, const ActionContext& context, Edit& edit)
        : action_(action), next_(next), context_(context), edit_(edit) {}

    Status set_parameter();
    Status set_parameters();
    Status put_release();
    Status trigger_release();
    Status put_barrier();
    Status put_building();
    Status put_zone();
    Status put_bed();
    Status put_inflow();
    Status put_gauge();
    Status put_note();
    /// An observation, a trigger or an alarm.
    Status put_table(TableKind kind, const char* what);
    template <class Entries>
    Status remove(Entries& entries, const char* what);

  private:
    /// The key and the value of an object; adds to the sentence.
    Status set_parameter(const json& entry);
    [[nodiscard]] Result<std::string> id() const;
    [[nodiscard]] static Error no_such(const std::string& id, const char* what);
    /// Changes the entry that the action names, or adds one. `read(existing, name)` makes the body of `existing`, which
    /// is nullptr for a new one; `add(body)` makes an entry of it; `tell(entry, existing)` says what is done.
    template <class Entry, class Read, class Add, class Tell>
    Status put(std::vector<Entry>& entries, const char* what, int& number, const Read& read, const Add& add,
               const Tell& tell);
    [[nodiscard]] const char* from_restart() const { return context_.begun ? ", from the next restart" : ""; }

    const json& action_;
    NextNumbers& next_;
    const ActionContext& context_;
    Edit& edit_;
};

/// Objects of one kind that a session may draw: each change looks through all of them.
constexpr std::ptrdiff_t max_drawn = 200;

template <class Entry>
std::ptrdiff_t drawn(const std::vector<Entry>& entries) {
    return std::count_if(entries.begin(), entries.end(), [](const Entry& entry) {
        if constexpr (requires { entry.scene_index; })
            return entry.scene_index < 0;
        else if constexpr (requires { entry.from_scene; })
            return !entry.from_scene;
        else
            return true;
    });
}

std::string in_quotes(const std::string& name) {
    return "\"" + name + "\"";
}

const std::string& name_of(const terrain::Release& release) {
    return release.name;
}
const std::string& name_of(const terrain::Building& building) {
    return building.name;
}
const std::string& name_of(const scene::Zone& zone) {
    return zone.spec.name;
}
const std::string& name_of(const scene::BedLayer& layer) {
    return layer.spec.name;
}
const std::string& name_of(const terrain::Inflow& inflow) {
    return inflow.name;
}
const std::string& name_of(const terrain::Gauge& gauge) {
    return gauge.name;
}
const std::string& name_of(const Note& note) {
    return note.name;
}
std::string name_of(const TableEntry& entry) {
    return entry.name();
}

Result<std::string> ActionReader::id() const {
    TALUS_ASSIGN(auto text, read_text(action_, "id"));
    return text.value_or("");
}

Error ActionReader::no_such(const std::string& id, const char* what) {
    if (id.empty()) return Error{fmt::format("id: missing; it must name a {}", what)};
    return Error{fmt::format("id = {}: there is no such {}", shown(json(id)), what)};
}

Status ActionReader::set_parameter() {
    TALUS_TRY(check_keys(action_, {"action", "key", "value"}));
    return set_parameter(action_);
}

/// Several at once are one change, which a single undo reverts.
Status ActionReader::set_parameters() {
    TALUS_TRY(check_keys(action_, {"action", "values"}));
    const auto values = action_.find("values");
    if (values == action_.end() || !values->is_object() || values->empty()) {
        return Error{"values: must be an object of keys such as material.friction_coefficient with their values"};
    }
    for (const auto& [key, value] : values->items()) {
        TALUS_TRY(set_parameter({{"key", key}, {"value", value}}));
    }
    return {};
}

Status ActionReader::set_parameter(const json& entry) {
    TALUS_ASSIGN(const auto key, read_text(entry, "key"));
    const auto found =
        std::find_if(live_parameters().begin(), live_parameters().end(),
                     [&](const params::Parameter* p) { return key.has_value() && "material." + p->key == *key; });
    if (found == live_parameters().end()) {
        std::vector<std::string> names;
        for (const params::Parameter* p : live_parameters()) names.push_back("material." + p->key);
        return Error{
            fmt::format("key = {}: must be one of {}", shown(entry.value("key", json())), fmt::join(names, ", "))};
    }
    const params::Parameter& parameter = **found;
    const auto value = read_number(entry, "value", parameter.range, parameter.unit);
    if (!value) return Error{fmt::format("{}: {}", *key, value.error().message)};
    const bool may_follow = !parameter.absent.empty();  // null: equal to the key that it follows
    if (!*value && (!may_follow || !entry.contains("value"))) {
        return Error{fmt::format("{}: value: missing; must be {}", *key, allowed_text(parameter))};
    }
    const double before = value_in_force(edit_.setup.material, parameter, context_.viscosity);
    params::SceneSpec spec;
    spec.material = edit_.setup.material;
    parameter.set(spec, 0, *value ? params::ParameterValue(**value) : params::ParameterValue());
    if (parameter.key == "viscosity") spec.material.kinematic_viscosity.reset();
    if (parameter.key == "laminar_viscosity_m2ps") spec.material.laminar_dynamic_viscosity.reset();
    spec.solver = context_.scene.spec.solver;
    if (Status s = check_live_rules(*params::find_section("material"), spec, context_.particle_spacing); !s) {
        return Error{"material." + s.error().message};
    }
    if (const auto broken = scene::too_viscous(spec.material, spec.solver, context_.particle_spacing)) {
        return Error{"material." + broken->key + broken->text};
    }
    edit_.setup.material = spec.material;
    const double after = value_in_force(edit_.setup.material, parameter, context_.viscosity);
    const auto shown_value = [](double number) { return std::isnan(number) ? "none" : fmt::format("{:.6g}", number); };
    if (!edit_.sentence.empty()) edit_.sentence += ", ";
    edit_.sentence += fmt::format("{} {} -> {}{}{}", label_of(parameter), shown_value(before), shown_value(after),
                                  parameter.unit.empty() ? "" : " ", parameter.unit);
    return {};
}

template <class Entry, class Read, class Add, class Tell>
Status ActionReader::put(std::vector<Entry>& entries, const char* what, int& number, const Read& read, const Add& add,
                         const Tell& tell) {
    TALUS_ASSIGN(const auto given_id, id());
    Entry* existing = find_id(entries, given_id);
    if (!given_id.empty() && existing == nullptr) return no_such(given_id, what);
    if (existing == nullptr && drawn(entries) >= max_drawn) {
        return Error{fmt::format("{} {}s are drawn, the most there can be; remove one first", max_drawn, what)};
    }
    constexpr std::size_t longest = std::is_same_v<Entry, NoteSetup> ? 200 : 80;
    TALUS_ASSIGN(const auto name, read_text(action_, "name", longest));
    TALUS_ASSIGN(auto body, read(existing, name.value_or(existing != nullptr ? name_of(*existing->body)
                                                                             : fmt::format("{} {}", what, number))));
    Entry made = add(std::move(body));
    edit_.sentence = fmt::format("{} {}", what, in_quotes(name_of(*made.body))) + tell(made, existing);
    if (existing != nullptr) {
        existing->body = std::move(made.body);
        if constexpr (requires { existing->as_in_scene; }) existing->as_in_scene = false;
        if constexpr (requires { existing->area; }) existing->area = made.area;
        if constexpr (requires { existing->amount; }) existing->amount = made.amount;
        return {};
    }
    edit_.created = fmt::format("{}-{}", what, number++);  // incremented only on success
    made.id = edit_.created;
    entries.push_back(std::move(made));
    return {};
}

Status ActionReader::put_release() {
    return put(
        edit_.setup.releases, "release", next_.release,
        [&](const ReleaseSetup* existing, const std::string& name) {
            return read_release(action_, context_, edit_.setup, existing, name);
        },
        [](terrain::Release release) {
            return ReleaseSetup{"", std::make_shared<const terrain::Release>(std::move(release))};
        },
        [&](const ReleaseSetup& release, const ReleaseSetup* existing) {
            const double volume = release.body->volume;
            if (existing == nullptr) return fmt::format(": {:.0f} m3, waiting to be triggered", volume);
            return fmt::format(": {:.0f} m3 -> {:.0f} m3{}", existing->body->volume, volume,
                               context_.has_begun(existing->id) ? " from the next restart, its debris is moving" : "");
        });
}

Status ActionReader::put_barrier() {
    return put(
        edit_.setup.barriers, "barrier", next_.barrier,
        [&](const BarrierSetup* existing, const std::string& name) {
            return read_barrier(action_, context_, existing != nullptr ? existing->body.get() : nullptr, name);
        },
        [](terrain::Building body) {
            return BarrierSetup{"", std::make_shared<const terrain::Building>(std::move(body))};
        },
        [](const BarrierSetup& barrier, const BarrierSetup* existing) {
            const params::BarrierSpec& shape = barrier.shape();
            std::string size = fmt::format(" {}: {:.1f} m long, {:.3g} m high, {:.3g} m thick",
                                           existing != nullptr ? "changed" : "placed", terrain::length_of(shape.line),
                                           barrier.body->height, shape.thickness);
            if (!shape.passing_share) return size;
            return size + fmt::format(", a net: {:.3g} % pass its meshes", 100 * *shape.passing_share);
        });
}

Status ActionReader::put_building() {
    return put(
        edit_.setup.buildings, "building", next_.building,
        [&](const BuildingSetup* existing, const std::string& name) {
            return read_building(action_, context_, existing != nullptr ? existing->body.get() : nullptr, name);
        },
        [](terrain::Building body) {
            return BuildingSetup{"", std::make_shared<const terrain::Building>(std::move(body))};
        },
        [&](const BuildingSetup& building, const BuildingSetup* existing) {
            const char* done = existing == nullptr ? "placed" : action_.contains("move_m") ? "moved" : "changed";
            return fmt::format(" {}: {:.3g} m high", done, building.body->height);
        });
}

Status ActionReader::put_zone() {
    const GridGeometry& terrain = context_.scene.terrain.elevation().geometry;
    return put(
        edit_.setup.zones, "zone", next_.zone,
        [&](const ZoneSetup* existing, const std::string& name) {
            return read_zone(action_, context_, existing != nullptr ? existing->body.get() : nullptr, name);
        },
        [&](scene::Zone zone) {
            const double area = area_of(zone, terrain);
            return ZoneSetup{"", std::make_shared<const scene::Zone>(std::move(zone)), area};
        },
        [](const ZoneSetup& zone, const ZoneSetup* existing) {
            return fmt::format(" {}: {:.0f} m2", existing != nullptr ? "changed" : "drawn", zone.area);
        });
}

Status ActionReader::put_bed() {
    const terrain::Terrain& terrain = context_.scene.terrain;
    return put(
        edit_.setup.beds, "bed", next_.bed,
        [&](const BedSetup* existing, const std::string& name) {
            return read_bed(action_, context_, existing != nullptr ? existing->body.get() : nullptr, name);
        },
        [&](scene::BedLayer layer) {
            const scene::BedAmount amount = amount_of(layer, terrain);
            return BedSetup{"", std::make_shared<const scene::BedLayer>(std::move(layer)), amount};
        },
        [&](const BedSetup& bed, const BedSetup* existing) {
            return fmt::format(" {}: {:.0f} m3{}", existing != nullptr ? "changed" : "drawn", bed.amount.volume,
                               from_restart());
        });
}

Status ActionReader::put_inflow() {
    return put(
        edit_.setup.inflows, "inflow", next_.inflow,
        [&](const InflowSetup* existing, const std::string& name) {
            return read_inflow(action_, context_, edit_.setup, existing, name);
        },
        [](terrain::Inflow inflow) {
            return InflowSetup{"", std::make_shared<const terrain::Inflow>(std::move(inflow))};
        },
        [&](const InflowSetup& inflow, const InflowSetup* existing) {
            return fmt::format(" {}: {:.0f} m3{}", existing != nullptr ? "changed" : "drawn", inflow.body->volume(),
                               from_restart());
        });
}

Status ActionReader::put_gauge() {
    return put(
        edit_.setup.gauges, "gauge", next_.gauge,
        [&](const GaugeSetup* existing, const std::string& name) {
            return read_gauge_place(action_, context_, edit_.setup, existing, name);
        },
        [](terrain::Gauge gauge) {
            return GaugeSetup{"", std::make_shared<const terrain::Gauge>(std::move(gauge))};
        },
        [&](const GaugeSetup& gauge, const GaugeSetup* existing) {
            const std::string where = std::isnan(gauge.body->chainage)
                                          ? fmt::format("E {:.1f}, N {:.1f} m", gauge.body->at.x, gauge.body->at.y)
                                          : fmt::format("chainage {:.1f} m", gauge.body->chainage);
            return fmt::format(" {}: {}{}", existing != nullptr ? "changed" : "added", where, from_restart());
        });
}

Status ActionReader::put_note() {
    return put(
        edit_.setup.notes, "note", next_.note,
        [&](const NoteSetup* existing, const std::string& name) {
            return read_note(action_, context_, existing != nullptr ? existing->body.get() : nullptr, name);
        },
        [](Note note) {
            return NoteSetup{"", std::make_shared<const Note>(std::move(note))};
        },
        [](const NoteSetup&, const NoteSetup* existing) { return existing != nullptr ? " changed" : " pinned"; });
}

Status ActionReader::put_table(TableKind kind, const char* what) {
    return put(
        edit_.setup.tables(kind), what, next_.of(kind),
        [&](const TableSetup* existing, const std::string& name) {
            return read_table_action(action_, context_, edit_.setup, kind, existing, name);
        },
        [](TableEntry entry) {
            return TableSetup{"", std::make_shared<const TableEntry>(std::move(entry)), false};
        },
        [](const TableSetup&, const TableSetup* existing) { return existing != nullptr ? " changed" : " added"; });
}

Status ActionReader::trigger_release() {
    TALUS_TRY(check_keys(action_, {"action", "id"}));
    TALUS_ASSIGN(const auto given, id());
    ReleaseSetup* release = find_id(edit_.setup.releases, given);
    if (release == nullptr) return no_such(given, "release");
    if (release->triggered || context_.has_begun(release->id)) {
        return Error{
            fmt::format("id = {}: release {} has already started", shown(json(given)), in_quotes(release->body->name))};
    }
    release->triggered = true;
    edit_.sentence =
        fmt::format("release {} triggered: {:.0f} m3", in_quotes(release->body->name), release->body->volume);
    return {};
}

template <class Entries>
Status ActionReader::remove(Entries& entries, const char* what) {
    TALUS_TRY(check_keys(action_, {"action", "id"}));
    TALUS_ASSIGN(const auto given, id());
    const auto* entry = find_id(entries, given);
    if (entry == nullptr) return no_such(given, what);
    using Entry = std::remove_cvref_t<decltype(*entry)>;
    constexpr bool from_time_0 =
        std::is_same_v<Entry, BedSetup> || std::is_same_v<Entry, InflowSetup> || std::is_same_v<Entry, GaugeSetup>;
    edit_.sentence =
        fmt::format("{} {} removed{}", what, in_quotes(name_of(*entry->body)), from_time_0 ? from_restart() : "");
    entries.erase(entries.begin() + (entry - entries.data()));
    return {};
}

}  // namespace

Result<std::string> action_name(const json& action) {
    if (!action.is_object()) return Error{fmt::format("the action {} must be a JSON object", shown(action))};
    TALUS_ASSIGN(auto name, read_text(action, "action"));
    if (!name) return Error{"action: missing; it must name what to do, such as set_parameter"};
    return *name;
}

Result<Edit> read_action(const json& action, const Setup& setup, NextNumbers& next, const ActionContext& context) {
    TALUS_ASSIGN(const std::string name, action_name(action));
    Edit edit{setup, "", ""};
    ActionReader reader(action, next, context, edit);
    Setup& changed = edit.setup;
    const std::pair<const char*, std::function<Status()>> actions[] = {
        {"set_parameter", [&] { return reader.set_parameter(); }},
        {"set_parameters", [&] { return reader.set_parameters(); }},
        {"put_release", [&] { return reader.put_release(); }},
        {"remove_release", [&] { return reader.remove(changed.releases, "release"); }},
        {"trigger_release", [&] { return reader.trigger_release(); }},
        {"put_barrier", [&] { return reader.put_barrier(); }},
        {"remove_barrier", [&] { return reader.remove(changed.barriers, "barrier"); }},
        {"put_building", [&] { return reader.put_building(); }},
        {"remove_building", [&] { return reader.remove(changed.buildings, "building"); }},
        {"put_zone", [&] { return reader.put_zone(); }},
        {"remove_zone", [&] { return reader.remove(changed.zones, "zone"); }},
        {"put_bed", [&] { return reader.put_bed(); }},
        {"remove_bed", [&] { return reader.remove(changed.beds, "bed"); }},
        {"put_inflow", [&] { return reader.put_inflow(); }},
        {"remove_inflow", [&] { return reader.remove(changed.inflows, "inflow"); }},
        {"put_gauge", [&] { return reader.put_gauge(); }},
        {"remove_gauge", [&] { return reader.remove(changed.gauges, "gauge"); }},
        {"put_note", [&] { return reader.put_note(); }},
        {"remove_note", [&] { return reader.remove(changed.notes, "note"); }},
        {"put_observation", [&] { return reader.put_table(TableKind::observation, "observation"); }},
        {"remove_observation", [&] { return reader.remove(changed.observations, "observation"); }},
        {"put_trigger", [&] { return reader.put_table(TableKind::trigger, "trigger"); }},
        {"remove_trigger", [&] { return reader.remove(changed.triggers, "trigger"); }},
        {"put_alarm", [&] { return reader.put_table(TableKind::alarm, "alarm"); }},
        {"remove_alarm", [&] { return reader.remove(changed.alarms, "alarm"); }},
    };
    const auto wanted = std::find_if(std::begin(actions), std::end(actions),
                                     [&](const auto& action_and_work) { return action_and_work.first == name; });
    if (wanted == std::end(actions)) {
        std::vector<std::string> names;
        for (const auto& [known, work] : actions) names.emplace_back(known);
        return Error{fmt::format("action = {}: must be one of {}, undo, redo, restart, run, pause, step, set_speed",
                                 shown(json(name)), fmt::join(names, ", "))};
    }
    TALUS_TRY(wanted->second());
    return edit;
}

}  // namespace talus::twin
