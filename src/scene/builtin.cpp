#include "scene/builtin.hpp"

#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "builtin_scene_files.hpp"

namespace talus {

Result<std::filesystem::path> unpack_builtin_scene(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return Error{fmt::format("{}: cannot make this folder: {}", folder.string(), error.message())};
    for (const auto& file : builtin_scene_files::files) {
        const auto path = folder / file.name;
        std::ofstream stream(path, std::ios::binary);
        stream.write(file.content.data(), static_cast<std::streamsize>(file.content.size()));
        stream.close();
        if (!stream) return Error{fmt::format("{}: cannot write this file; is the disk full?", path.string())};
    }
    return folder / "scene.toml";
}

}  // namespace talus
