#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/geometry.hpp"
#include "params/fields.hpp"
#include "params/spec.hpp"
#include "scene/scene.hpp"
#include "terrain/buildings.hpp"
#include "terrain/release.hpp"

/// What people can change of a run while it runs: a plain value. Bodies are shared between setups, so that a copy costs
/// little.
namespace talus::twin {

struct ReleaseSetup {
    std::string id;
    std::shared_ptr<const Release> body;  ///< a drawn one has no start time of its own (infinity)
    int scene_index = -1;                 ///< of the scene's; -1: made by somebody
    bool as_in_scene = false;             ///< of the scene, and its body not changed
    bool triggered = false;               ///< by somebody, whatever its start time
};

struct BarrierSetup {
    std::string id;
    std::shared_ptr<const Building> body;  ///< with its Building::barrier
    bool from_scene = false;

    [[nodiscard]] const BarrierShape& shape() const { return *body->barrier; }
};

struct BuildingSetup {
    std::string id;
    std::shared_ptr<const Building> body;
    int scene_index = -1;  ///< of the scene's; -1: made by somebody
    bool as_in_scene = false;
};

struct Setup {
    MaterialSpec material;
    std::vector<ReleaseSetup> releases;
    std::vector<BarrierSetup> barriers;
    std::vector<BuildingSetup> buildings;
};

/// The numbers that the next new things get in their ids; an id is never used twice.
struct NextNumbers {
    int release = 1, barrier = 1, building = 1;
};

/// The scene as it was loaded; `next` is set to what comes behind it.
[[nodiscard]] Setup setup_of(const Scene& scene, NextNumbers& next);

/// The entry of that id; nullptr: none.
template <class Entry>
[[nodiscard]] auto* find_id(Entry& entries, const std::string& id) {
    for (auto& entry : entries) {
        if (entry.id == id) return &entry;
    }
    return static_cast<decltype(&entries.front())>(nullptr);
}

/// Whether two bodies are the same but for their names.
[[nodiscard]] bool same_shape(const std::shared_ptr<const Release>& a, const std::shared_ptr<const Release>& b);
[[nodiscard]] bool same_shape(const std::shared_ptr<const Building>& a, const std::shared_ptr<const Building>& b);

/// The keys of the material section that can change while debris moves, as declared for the scene file.
[[nodiscard]] const std::vector<const Parameter*>& levers();

/// "friction coefficient", from "friction_coefficient"; without the unit that the key ends with.
[[nodiscard]] std::string label_of(const Parameter& parameter);

/// The value that holds, in the unit of the key: one that is not set apart is that of what it follows; NaN where it
/// follows nothing.
/// `viscosity`: as make_model takes it, where the scene gives it as kinematic viscosity.
[[nodiscard]] double value_in_force(const MaterialSpec& material, const Parameter& lever, double viscosity);

}  // namespace talus::twin
