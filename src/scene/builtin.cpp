#include "scene/builtin.hpp"

#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "builtin_scene_files.hpp"
#include "core/try.hpp"
#include "params/paths.hpp"

namespace talus::scene {

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

void name_unpacked_files(Scene& scene, const std::filesystem::path& folder, const std::string& name) {
    const std::string prefix = (folder / "").string();
    const auto named = [&](const std::string& path) {
        if (!path.starts_with(prefix)) return path;
        return fmt::format("{}/{}", name, path.substr(prefix.size()));
    };
    scene.file = named(scene.file.string());
    for (InputFile& input : scene.inputs) input.path = named(input.path);
    params::replace_paths(scene.spec, named);
}

Result<Scene> load_builtin_scene(const std::filesystem::path& folder, const std::vector<std::string>& overrides) {
    TALUS_ASSIGN(const auto file, unpack_builtin_scene(folder));
    TALUS_ASSIGN(auto scene, load_scene(file, overrides));
    name_unpacked_files(scene, folder, fmt::format("built-in:{}", builtin_scene_name));
    return scene;
}

}  // namespace talus::scene
