#include <cstdlib>
#include <filesystem>
#include <variant>

#include <fmt/format.h>

#include "core/input_file.hpp"
#include "core/try.hpp"
#include "geo/file_name.hpp"
#include "scene/parse.hpp"

namespace talus::scene {
namespace {

/// Replaces every `${NAME}`; the error is the end of a message about the key.
Result<std::string> expand_environment(const std::string& text) {
    std::string out;
    std::size_t begin = 0;
    while (true) {
        const std::size_t dollar = text.find("${", begin);
        out += text.substr(begin, dollar - begin);
        if (dollar == std::string::npos) return out;
        const std::size_t close = text.find('}', dollar);
        if (close == std::string::npos) return Error{"has a \"${\" without \"}\""};
        const std::string name = text.substr(dollar + 2, close - dollar - 2);
        const char* value = name.empty() ? nullptr : std::getenv(name.c_str());
        if (!value || !*value) return Error{fmt::format("needs the environment variable {}, which is not set", name)};
        out += value;
        begin = close + 1;
    }
}

bool can_name_a_layer(const params::Section& section, const params::Parameter& parameter) {
    return section.find("layer") != nullptr && (parameter.key == "file" || parameter.key == "polygon_file");
}

/// Takes the layer behind a vector file's name, as in "map.gpkg|layername=scar", into the key `layer` of its section.
Result<std::string> take_layer(ParsedScene& scene, const params::Section& section, std::size_t index,
                               const params::Parameter& parameter, const std::string& text) {
    if (!can_name_a_layer(section, parameter) || text.find('|') == std::string::npos) return text;
    const params::Parameter* layer = section.find("layer");
    std::error_code failed;
    if (std::filesystem::exists(scene.file.parent_path() / text, failed)) return text;
    TALUS_ASSIGN(const geo::LayerOfFile named, geo::split_layer(text));
    const params::ParameterValue value = layer->get(scene.spec, index);
    const auto* given = std::get_if<std::string>(&value);
    if (given != nullptr && !given->empty() && *given != named.layer) {
        return Error{fmt::format("names the layer \"{}\", and layer = \"{}\" another", named.layer, *given)};
    }
    layer->set(scene.spec, index, named.layer);
    return named.file;
}

Status resolve_paths(ParsedScene& scene) {
    for (const params::Section& section : params::scene_sections()) {
        for (std::size_t index = 0; index < section.count(scene.spec); ++index) {
            for (const params::Parameter& parameter : section.parameters) {
                const params::ParameterValue value = parameter.get(scene.spec, index);
                const auto* text = std::get_if<std::string>(&value);
                if (parameter.kind != params::ParameterKind::path || !text) continue;
                const Result<std::string> expanded = expand_environment(*text);
                if (!expanded) {
                    const std::string& obtain = scene.spec.terrain.obtain;
                    const bool tell = section.name == "terrain" && !obtain.empty();
                    return Error{fmt::format("{} = {} {}{}", scene.at(key_path(section, index, parameter)),
                                             params::toml_text(value), expanded.error().message,
                                             tell ? "; to obtain the file: " + one_line(obtain, 4000) : "")};
                }
                const Result<std::string> file = take_layer(scene, section, index, parameter, *expanded);
                if (!file) return Error{scene.at(key_path(section, index, parameter)) + ": " + file.error().message};
                const std::filesystem::path path = scene.file.parent_path() / *file;
                if (Status s = check_input_file(path); !s) {
                    return Error{scene.at(key_path(section, index, parameter)) + ": " + s.error().message};
                }
                parameter.set(scene.spec, index, geo::is_gdal_name(*file) ? *file : path.lexically_normal().string());
            }
        }
    }
    return {};
}

}  // namespace

std::string layer_behind(const ParsedScene& scene, const params::Section& section, std::size_t index,
                         const params::Parameter& parameter) {
    if (!can_name_a_layer(section, parameter)) return "";
    const params::Parameter& layer = *section.find("layer");
    if (scene.places.contains(key_path(section, index, layer))) return "";
    const params::ParameterValue value = layer.get(scene.spec, index);
    const auto* name = std::get_if<std::string>(&value);
    return name == nullptr || name->empty() ? "" : "|layername=" + *name;
}

Status check_rules(const ParsedScene& scene, double particle_spacing) {
    for (const params::Section& section : params::scene_sections()) {
        for (std::size_t index = 0; index < section.count(scene.spec); ++index) {
            auto broken = wrong_choice(section, scene.spec, index, false);
            if (!broken) broken = broken_rule(section, scene.spec, index, particle_spacing);
            if (!broken) continue;
            return Error{scene.at(key_path(section, index, *section.find(broken->key))) + broken->text};
        }
    }
    return {};
}

Status finish_scene(ParsedScene& scene) {
    for (std::size_t i = 0; i < scene.spec.releases.size(); ++i) {
        const params::ReleaseSpec& release = scene.spec.releases[i];
        if (!release.file.empty() || !release.thickness_raster.empty()) continue;
        return Error{scene.at(fmt::format("release[{}].file", i)) +
                     " is missing; it must be a file path in quotes, or thickness_raster be given"};
    }
    TALUS_TRY(check_rules(scene, 0));
    for (std::size_t i = 0; i < scene.spec.beds.size(); ++i) {
        const params::BedSpec& bed = scene.spec.beds[i];
        if (bed.law == params::EntrainmentLaw::growth || !bed.growth_rate) continue;
        return Error{scene.at(fmt::format("bed[{}].growth_rate_per_m", i)) + ": is not for law = \"shear\""};
    }
    return resolve_paths(scene);
}

}  // namespace talus::scene
