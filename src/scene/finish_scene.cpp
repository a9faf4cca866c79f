#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/parse.hpp"

namespace talus {
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

/// GDAL also opens names that are no path, such as NETCDF:"file.nc":band.
bool is_driver_name(const std::string& text) {
    const std::size_t colon = text.find(':');
    return colon != std::string::npos && colon >= 2 &&
           text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == colon;
}

Status resolve_paths(ParsedScene& scene) {
    for (const Section& section : scene_sections()) {
        for (std::size_t index = 0; index < section.count(scene.spec); ++index) {
            for (const Parameter& parameter : section.parameters) {
                const ParameterValue value = parameter.get(scene.spec, index);
                const auto* text = std::get_if<std::string>(&value);
                if (parameter.kind != ParameterKind::path || !text) continue;
                const Result<std::string> expanded = expand_environment(*text);
                if (!expanded) {
                    const std::string& obtain = scene.spec.terrain.obtain;
                    const bool tell = section.name == "terrain" && !obtain.empty();
                    return Error{fmt::format("{} = {} {}{}", scene.at(key_path(section, index, parameter)),
                                             toml_text(value), expanded.error().message,
                                             tell ? "; to obtain the file: " + one_line(obtain, 4000) : "")};
                }
                const std::filesystem::path path = scene.file.parent_path() / *expanded;
                parameter.set(scene.spec, index,
                              is_driver_name(*expanded) ? *expanded : path.lexically_normal().string());
            }
        }
    }
    return {};
}

Status check_release(const ParsedScene& scene, std::size_t index) {
    const ReleaseSpec& release = scene.spec.releases[index];
    const std::string path = fmt::format("release[{}]", index);
    std::vector<std::string> given;
    if (release.thickness) given.emplace_back("thickness_m");
    if (!release.thickness_attribute.empty()) given.emplace_back("thickness_attribute");
    if (!release.thickness_raster.empty()) given.emplace_back("thickness_raster");
    if (release.volume) given.emplace_back("volume_m3");
    if (given.size() != 1) {
        std::string list;
        for (const std::string& key : given) list += (list.empty() ? "" : ", ") + key;
        return Error{
            fmt::format("{}: exactly one of thickness_m, thickness_attribute, thickness_raster, volume_m3 must "
                        "be given; {}",
                        scene.at(given.empty() ? path + ".file" : path + "." + given.back()),
                        given.empty() ? "there is none" : "given are " + list)};
    }
    if (release.start_time >= scene.spec.solver.end_time) {
        return Error{fmt::format("{} = {} is refused; it must be below solver.end_time_s = {}",
                                 scene.at(path + ".start_time_s"), release.start_time, scene.spec.solver.end_time)};
    }
    return {};
}

Status check_bed(const ParsedScene& scene, std::size_t index) {
    const BedSpec& bed = scene.spec.beds[index];
    const std::string path = fmt::format("bed[{}]", index);
    std::vector<std::string> given;
    if (bed.depth) given.emplace_back("depth_m");
    if (!bed.depth_attribute.empty()) given.emplace_back("depth_attribute");
    if (!bed.depth_raster.empty()) given.emplace_back("depth_raster");
    if (given.size() != 1) {
        return Error{
            fmt::format("{}: exactly one of depth_m, depth_attribute, depth_raster must be given; {}",
                        scene.at(given.empty() ? path + ".name" : path + "." + given.back()),
                        given.empty() ? "there is none" : fmt::format("given are {}", fmt::join(given, ", ")))};
    }
    if (!bed.depth_attribute.empty() && bed.file.empty()) {
        return Error{fmt::format("{} = \"{}\" needs the polygons that have it; give {}.file",
                                 scene.at(path + ".depth_attribute"), one_line(bed.depth_attribute, 80), path)};
    }
    const bool grows = bed.law == EntrainmentLaw::growth;
    if (grows != bed.growth_rate.has_value()) {
        return Error{fmt::format("{}: {}", scene.at(path + (grows ? ".law" : ".growth_rate_per_m")),
                                 grows ? "law = \"growth\" needs growth_rate_per_m: ln(volume after / volume before) "
                                         "over the length of the bed, above 0 to 1 (1/m)"
                                       : "growth_rate_per_m is not for law = \"shear\"")};
    }
    return {};
}

}  // namespace

Status finish_scene(ParsedScene& scene) {
    for (std::size_t i = 0; i < scene.spec.beds.size(); ++i) {
        if (Status s = check_bed(scene, i); !s) return s.error();
    }
    for (std::size_t i = 0; i < scene.spec.releases.size(); ++i) {
        if (Status s = check_release(scene, i); !s) return s.error();
    }
    const SolverSpec& solver = scene.spec.solver;
    if (solver.smallest_time_step > solver.largest_time_step) {
        const bool small_given = scene.places.count("solver.smallest_time_step_s") > 0;
        return Error{
            fmt::format("{} = {} is refused; smallest_time_step_s = {} must not be above largest_time_step_s = {}",
                        scene.at(small_given ? "solver.smallest_time_step_s" : "solver.largest_time_step_s"),
                        small_given ? solver.smallest_time_step : solver.largest_time_step, solver.smallest_time_step,
                        solver.largest_time_step)};
    }
    return resolve_paths(scene);
}

}  // namespace talus
