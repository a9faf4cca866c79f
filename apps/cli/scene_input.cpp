#include "scene_input.hpp"

#include <filesystem>
#include <utility>

#include "command.hpp"
#include "core/isolation.hpp"
#include "core/try.hpp"
#include "layers.hpp"
#include "scene/builtin.hpp"
#include "scene/bundle.hpp"

namespace talus::cli {

namespace fs = std::filesystem;

Result<SceneFile> find_scene(const std::string& scene, InterruptWatch& watch) {
    SceneFile s;
    const bool built_in = scene.empty() || scene.starts_with(builtin_prefix);
    fs::path given = scene;
    if (!built_in && !scene::is_bundle(given) && scene::is_bundle(given.parent_path())) given = given.parent_path();
    if (!built_in && !scene::is_bundle(given)) {
        s.file = given;
        s.name = fs::absolute(given).lexically_normal().string();
        const std::string stem = given.stem().string();
        const std::string folder = fs::absolute(given).parent_path().filename().string();
        s.short_name = stem == "scene" && !folder.empty() ? folder : stem;
        return Result<SceneFile>(std::move(s));
    }
    s.unpacked = std::make_unique<TemporaryFolder>();
    if (s.unpacked->path().empty()) return Error{"cannot make a temporary folder for the scene; set TMPDIR"};
    watch.remove_at_once(s.unpacked->path());
    if (built_in) {
        TALUS_ASSIGN(s.file, scene::unpack_builtin_scene(s.unpacked->path()));
        s.short_name = scene::builtin_scene_name;
        s.name = builtin_prefix + s.short_name;
    } else {
        if (const std::string lacks = missing_isolation(available_isolation()); !lacks.empty()) note(lacks);
        geo::ForeignReader reader;
        reader.shall_end = [&watch] { return watch.stop_requested().load(); };
        TALUS_ASSIGN(auto unpacked, scene::unpack_bundle(given, s.unpacked->path(), {}, reader));
        s.file = std::move(unpacked.scene);
        s.originals = std::move(unpacked.originals);
        s.short_name = given.stem().string();
        s.name = fs::absolute(given).lexically_normal().string();
    }
    return Result<SceneFile>(std::move(s));
}

Result<SceneInput> open_scene(const std::string& scene, const std::vector<std::string>& overrides,
                              const std::string& layers, InterruptWatch& watch) {
    SceneInput s;
    TALUS_ASSIGN(s.source.overrides, with_layers(overrides, layers));
    TALUS_ASSIGN(static_cast<SceneFile&>(s), find_scene(scene, watch));
    s.source.file = s.file;
    TALUS_ASSIGN(s.scene, load_layered(s.source.file, s.source.overrides, layers));
    name_originals(s.scene, s.originals);
    return Result<SceneInput>(std::move(s));
}

}  // namespace talus::cli
