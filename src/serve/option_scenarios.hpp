#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "run/variants.hpp"
#include "scene/scene.hpp"
#include "session/scenarios.hpp"

namespace talus::serve {

/// An option of a scene as the actions with which people would put it in force.
struct OptionScenario {
    std::string name;
    std::vector<nlohmann::json> actions;
};

/// The options of the scene, which is loaded from `source` and has none in force, as many as there are places beside
/// it. One with a zone that cannot be drawn in the page, of several parts or from a raster, is left out.
[[nodiscard]] std::vector<OptionScenario> option_scenarios(const scene::Scene& scene, const run::SceneSource& source);

/// Makes each of them a scenario beside the first one, with its name, paused at time 0. On the thread of the scenarios.
void offer_options(session::Scenarios& scenarios, const std::vector<OptionScenario>& options);

}  // namespace talus::serve
