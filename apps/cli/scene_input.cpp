#include "scene_input.hpp"

#include <filesystem>
#include <utility>

#include "core/try.hpp"
#include "layers.hpp"
#include "scene/builtin.hpp"

namespace talus::cli {

namespace fs = std::filesystem;

Result<SceneInput> open_scene(const std::string& scene, const std::vector<std::string>& overrides,
                              const std::string& layers, InterruptWatch& watch) {
    SceneInput s;
    TALUS_ASSIGN(s.source.overrides, with_layers(overrides, layers));
    if (scene.empty() || scene.starts_with(builtin_prefix)) {
        s.unpacked = std::make_unique<TemporaryFolder>();
        if (s.unpacked->path().empty())
            return Error{"cannot make a temporary folder for the built-in scene; set TMPDIR"};
        watch.remove_at_once(s.unpacked->path());
        TALUS_ASSIGN(s.source.file, scene::unpack_builtin_scene(s.unpacked->path()));
        s.short_name = scene::builtin_scene_name;
        s.name = builtin_prefix + s.short_name;
    } else {
        s.source.file = scene;
        s.name = fs::absolute(scene).lexically_normal().string();
        const std::string stem = s.source.file.stem().string();
        const std::string folder = fs::absolute(scene).parent_path().filename().string();
        s.short_name = stem == "scene" && !folder.empty() ? folder : stem;
    }
    TALUS_ASSIGN(s.scene, load_layered(s.source.file, s.source.overrides, layers));
    return Result<SceneInput>(std::move(s));
}

}  // namespace talus::cli
