#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "scene/scene.hpp"

/// --save-state and --from-state: files from which a run goes on.
namespace talus::cli {

/// What --save-state asks for.
struct SavedState {
    std::filesystem::path file;
    std::optional<double> time = {};  ///< s; absent: the end of the run
};

/// Of "FILE" or "FILE@TIME". Errors: the file cannot be written there, it would lie in the result folder, or runs of
/// the scene have no state that can be saved.
[[nodiscard]] Result<SavedState> read_save_option(const std::string& option, const scene::Scene& scene,
                                                  const std::filesystem::path& results);

/// The state in a file that --save-state has written. Errors: it is no such file; runs of the scene cannot start from
/// one.
[[nodiscard]] Result<std::string> read_state_file(const std::filesystem::path& file, const scene::Scene& scene);

[[nodiscard]] Status write_state_file(const std::filesystem::path& file, const std::string& state);

}  // namespace talus::cli
