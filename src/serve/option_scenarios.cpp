#include "serve/option_scenarios.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/result.hpp"
#include "params/fields.hpp"
#include "terrain/buildings.hpp"
#include "twin/json_keys.hpp"
#include "twin/section_values.hpp"

namespace talus::serve {
namespace {

using nlohmann::json;

/// Without keys that are not given: null would remove them.
json given(json values) {
    for (auto it = values.begin(); it != values.end();) it = it->is_null() ? values.erase(it) : std::next(it);
    return values;
}

/// Buildings are numbered in the order of the scene.
void add_removals(const scene::Scene& scene, const params::OptionSpec& option, std::vector<json>& actions) {
    int number = 0;
    for (const terrain::Building& building : scene.buildings) {
        if (building.barrier) continue;
        ++number;
        const auto& removed = option.removed_buildings;
        if (std::find(removed.begin(), removed.end(), building.name) == removed.end()) continue;
        actions.push_back({{"action", "remove_building"}, {"id", fmt::format("building-{}", number)}});
    }
}

void add_barriers(const scene::Scene& scene, const scene::Scene& with, std::vector<json>& actions) {
    for (const terrain::Building& barrier : with.buildings) {
        const bool there = std::any_of(scene.buildings.begin(), scene.buildings.end(),
                                       [&](const auto& other) { return other.barrier && other.name == barrier.name; });
        if (!barrier.barrier || there) continue;
        json action = given(twin::values_json(*barrier.barrier));
        action["action"] = "put_barrier";
        action["name"] = barrier.name;
        action["line"] = twin::to_json(barrier.barrier->line);
        action["openings"] = twin::list_json(barrier.barrier->openings);
        actions.push_back(std::move(action));
    }
}

/// False: one of them cannot be drawn.
bool add_zones(const scene::Scene& scene, const scene::Scene& with, std::vector<json>& actions) {
    for (const scene::Zone& zone : with.zones) {
        const bool there = std::any_of(scene.zones.begin(), scene.zones.end(),
                                       [&](const auto& other) { return other.spec.name == zone.spec.name; });
        if (there) continue;
        if (zone.outline.size() != 1 || !zone.outline.front().holes.empty()) return false;
        json action = given(twin::values_json(zone.spec));
        action["action"] = "put_zone";
        action["name"] = zone.spec.name;
        action["polygon"] = twin::to_json(zone.outline.front().outer);
        actions.push_back(std::move(action));
    }
    return true;
}

}  // namespace

std::vector<OptionScenario> option_scenarios(const scene::Scene& scene, const run::SceneSource& source) {
    std::vector<OptionScenario> all;
    if (!scene.spec.scene.option.empty()) return all;
    for (const params::OptionSpec& option : scene.spec.options) {
        if (all.size() + 1 == static_cast<std::size_t>(session::Scenarios::max_count)) break;
        std::vector<std::string> overrides = source.overrides;
        overrides.push_back("scene.option=" + params::toml_text(option.name));
        const Result<scene::Scene> with = scene::load_scene(source.file, overrides);
        if (!with) continue;
        OptionScenario made{option.name, {}};
        add_removals(scene, option, made.actions);
        add_barriers(scene, *with, made.actions);
        if (add_zones(scene, *with, made.actions)) all.push_back(std::move(made));
    }
    return all;
}

void offer_options(session::Scenarios& scenarios, const std::vector<OptionScenario>& options) {
    for (const OptionScenario& option : options) {
        scenarios.copy(0, nullptr, "", [&scenarios, option](const Result<session::Copied>& copied) {
            const std::optional<int> index = copied ? scenarios.find(copied->name) : std::nullopt;
            if (!index) return;
            const auto ignored = [](const Result<twin::Done>&) {};
            scenarios.act(*index, {{"action", "name_scenario"}, {"name", option.name}}, "", ignored);
            for (const json& action : option.actions) scenarios.act(*index, action, "", ignored);
        });
    }
}

}  // namespace talus::serve
