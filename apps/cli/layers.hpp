#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "command.hpp"
#include "core/result.hpp"
#include "run/cost.hpp"
#include "scene/scene.hpp"

/// --layers: how many particles thick the debris is, and what that costs.
namespace talus::cli {

/// --layers N, or `real_time` if the command runs one scene alone.
void add_layers(CLI::App& command, std::string& layers, bool real_time);

/// The overrides with that of --layers ("": none; "real-time": one layer at first). Errors: no such number of layers;
/// two options that choose the particle spacing.
[[nodiscard]] Result<std::vector<std::string>> with_layers(std::vector<std::string> overrides,
                                                           const std::string& layers);

/// Loads the scene; errors about the number of layers name the option.
[[nodiscard]] Result<scene::Scene> load_layered(const std::filesystem::path& file,
                                                const std::vector<std::string>& overrides, const std::string& layers);

struct LayersCost {
    double layers = 0;
    run::Cost cost;
};

/// What the layers of a scene cost; nothing where none are asked for or the user interrupts. With "real-time", loads
/// the scene again with the number of layers that it finds, which it adds to `overrides`. `say` is told of what takes
/// seconds; empty: nobody wants to know the cost.
[[nodiscard]] Result<std::optional<LayersCost>> settle_layers(const std::filesystem::path& file,
                                                              std::vector<std::string>& overrides,
                                                              const std::string& layers, scene::Scene& scene,
                                                              const std::function<void(const std::string&)>& say,
                                                              const std::atomic<bool>& stop_requested);

/// "3 layers: 31200 particles of 0.27 m, about 1:20 for 90 s of debris (1.1 x real time), 0.12 GB of memory".
[[nodiscard]] std::string cost_text(const LayersCost& settled);
/// The same as one JSON object in a line: {"event": "cost", ...}.
[[nodiscard]] std::string cost_json(const LayersCost& settled);

}  // namespace talus::cli
