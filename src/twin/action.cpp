#include "twin/action.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "scene/viscosity_limit.hpp"
#include "twin/json_keys.hpp"
#include "twin/kinds.hpp"
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
    Status trigger_release();
    template <class Kind>
    Status put();
    template <class Kind>
    Status remove();

  private:
    /// The key and the value of an object; adds to the sentence.
    Status set_parameter(const json& entry);
    [[nodiscard]] Result<std::string> id() const;
    [[nodiscard]] static Error no_such(const std::string& id, const char* what);
    const json& action_;
    NextNumbers& next_;
    const ActionContext& context_;
    Edit& edit_;
};

/// Objects of one kind that a session may draw: each change looks through all of them.
constexpr std::ptrdiff_t max_drawn = 200;

template <class Entry>
std::ptrdiff_t drawn(const std::vector<Entry>& entries) {
    return std::count_if(entries.begin(), entries.end(), [](const Entry& entry) { return entry.scene_index < 0; });
}

std::string in_quotes(const std::string& name) {
    return "\"" + name + "\"";
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

/// Changes the entry that the action names, or adds one.
template <class Kind>
Status ActionReader::put() {
    using Entry = typename Kind::Entry;
    std::vector<Entry>& entries = edit_.setup.*Kind::entries;
    int& number = next_.*Kind::number;
    TALUS_ASSIGN(const auto given_id, id());
    Entry* existing = find_id(entries, given_id);
    if (!given_id.empty() && existing == nullptr) return no_such(given_id, Kind::name);
    if (existing == nullptr && drawn(entries) >= max_drawn) {
        return Error{fmt::format("{} {}s are drawn, the most there can be; remove one first", max_drawn, Kind::name)};
    }
    TALUS_ASSIGN(const auto name, read_text(action_, "name", Kind::longest_name));
    json given = action_;
    given.erase("action");
    given.erase("id");
    const Put<Entry> put{
        given, context_, edit_.setup, existing,
        name.value_or(existing != nullptr ? Kind::name_of(*existing->body) : fmt::format("{} {}", Kind::name, number))};
    auto body = existing != nullptr ? *existing->body : Kind::fresh();
    TALUS_TRY(Kind::put(put, body));
    Entry made = existing != nullptr ? *existing : Entry();
    made.body = std::make_shared<const typename Kind::Body>(std::move(body));
    made.as_in_scene = false;
    Kind::measure(made, context_.scene.terrain);
    edit_.sentence = fmt::format("{} {}", Kind::name, in_quotes(Kind::name_of(*made.body))) + Kind::told(made, put);
    if (existing != nullptr) {
        *existing = std::move(made);
        return {};
    }
    edit_.created = made.id = fmt::format("{}-{}", Kind::name, number++);  // incremented only on success
    entries.push_back(std::move(made));
    return {};
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

template <class Kind>
Status ActionReader::remove() {
    TALUS_TRY(check_keys(action_, {"action", "id"}));
    TALUS_ASSIGN(const auto given, id());
    auto& entries = edit_.setup.*Kind::entries;
    const auto* entry = find_id(entries, given);
    if (entry == nullptr) return no_such(given, Kind::name);
    edit_.sentence = fmt::format("{} {} removed{}", Kind::name, in_quotes(Kind::name_of(*entry->body)),
                                 Kind::from_time_0 && context_.begun ? ", from the next restart" : "");
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
    std::vector<std::pair<std::string, std::function<Status()>>> actions = {
        {"set_parameter", [&] { return reader.set_parameter(); }},
        {"set_parameters", [&] { return reader.set_parameters(); }},
        {"trigger_release", [&] { return reader.trigger_release(); }}};
    for_each_kind([&]<class Kind>(Kind) {
        actions.emplace_back(std::string("put_") + Kind::name, [&] { return reader.template put<Kind>(); });
        actions.emplace_back(std::string("remove_") + Kind::name, [&] { return reader.template remove<Kind>(); });
    });
    const auto wanted = std::find_if(std::begin(actions), std::end(actions),
                                     [&](const auto& action_and_work) { return action_and_work.first == name; });
    if (wanted == std::end(actions)) {
        std::vector<std::string> names;
        names.reserve(actions.size());
        for (const auto& [known, work] : actions) names.emplace_back(known);
        return Error{fmt::format("action = {}: must be one of {}, undo, redo, restart, run, pause, step, set_speed",
                                 shown(json(name)), fmt::join(names, ", "))};
    }
    TALUS_TRY(wanted->second());
    return edit;
}

}  // namespace talus::twin
