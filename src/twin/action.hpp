#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/result.hpp"
#include "scene/scene.hpp"
#include "twin/setup.hpp"

namespace talus::twin {

/// Context against which an action is checked.
struct ActionContext {
    const scene::Scene& scene;
    double particle_spacing;  ///< m
    double viscosity;         ///< in force
    std::function<bool(const std::string& release_id)> has_begun;
    bool begun = false;  ///< at least one step was taken
};

/// The result of an action on a setup.
struct Edit {
    Setup setup;
    std::string sentence;
    std::string created;  ///< id; empty: nothing new
};

/// Reads an action of docs/protocol.md that edits the setup: all but restart, undo and redo. `next` is used for new
/// ids. Errors name key, value and allowed range.
[[nodiscard]] Result<Edit> read_action(const nlohmann::json& action, const Setup& setup, NextNumbers& next,
                                       const ActionContext& context);

/// The key "action" of an object. Errors: not an object, no such key, not a text.
[[nodiscard]] Result<std::string> action_name(const nlohmann::json& action);

}  // namespace talus::twin
