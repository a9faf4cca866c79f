#include "builtin_names.hpp"

#include <string>
#include <variant>

#include <fmt/format.h>

#include "params/fields.hpp"
#include "scene/builtin.hpp"

namespace talus {

void name_builtin_files(Scene& scene, const std::filesystem::path& unpacked) {
    const std::string prefix = (unpacked / "").string();
    const auto named = [&](const std::string& path) {
        if (!path.starts_with(prefix)) return path;
        return fmt::format("built-in:{}/{}", builtin_scene_name, path.substr(prefix.size()));
    };
    scene.file = named(scene.file.string());
    for (InputFile& input : scene.inputs) input.path = named(input.path);
    for (const Section& section : scene_sections()) {
        for (std::size_t index = 0; index < section.count(scene.spec); ++index) {
            for (const Parameter& parameter : section.parameters) {
                const ParameterValue value = parameter.get(scene.spec, index);
                const auto* path = std::get_if<std::string>(&value);
                if (parameter.kind == ParameterKind::path && path) parameter.set(scene.spec, index, named(*path));
            }
        }
    }
}

}  // namespace talus
