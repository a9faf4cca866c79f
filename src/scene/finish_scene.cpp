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

/// Which of the zone's keys are given, of those that say where it is.
Status check_zone(const ParsedScene& scene, std::size_t index) {
    const ZoneSpec& zone = scene.spec.zones[index];
    const std::string path = fmt::format("zone[{}].", index);
    const std::pair<const char*, bool> places[] = {
        {"file", !zone.file.empty()}, {"polygon", !zone.polygon.empty()}, {"raster", !zone.raster.empty()}};
    std::string given;
    int count = 0;
    for (const auto& [key, is_given] : places) {
        if (!is_given) continue;
        given += (count++ > 0 ? ", " : "") + std::string(key);
    }
    if (count != 1) {
        return Error{fmt::format("{}: exactly one of file, polygon, raster must be given; {}",
                                 scene.at(path + (count > 0 ? given.substr(given.rfind(' ') + 1) : "file")),
                                 count == 0 ? "there is none" : "given are " + given)};
    }
    if (zone.raster_value && zone.raster_holds != ZoneRaster::zone_number) {
        return Error{
            fmt::format("{}: is given, but zone[{}].raster_holds says that the cells hold a coefficient; leave "
                        "one of them out",
                        scene.at(path + "raster_value"), index)};
    }
    const bool says_something = zone.friction_coefficient || zone.turbulent_friction || zone.cohesion ||
                                zone.stem_density > 0 || zone.raster_holds != ZoneRaster::zone_number;
    if (says_something) return {};
    return Error{
        fmt::format("{}: the zone says nothing; give friction_coefficient, turbulent_friction_mps2, "
                    "cohesion_Pa, stem_density_pm2 or raster_holds",
                    scene.at(path + given))};
}

/// What the material asks for must go together.
Status check_material(const ParsedScene& scene) {
    const MaterialSpec& material = scene.spec.material;
    const double internal = material.internal_friction_coefficient.value_or(material.friction_coefficient);
    if (material.inertial_friction_coefficient && *material.inertial_friction_coefficient < internal) {
        return Error{fmt::format("{} = {} is refused; it must be at least the internal friction of slow shear, {}",
                                 scene.at("material.inertial_friction_coefficient"),
                                 *material.inertial_friction_coefficient, internal)};
    }
    if (scene.spec.solver.internal_friction == InternalFriction::stress) return {};
    const auto refuse = [&](const std::string& key) {
        return Error{fmt::format("{}: needs solver.internal_friction = \"stress\"; friction by pairs has no such law",
                                 scene.at(key))};
    };
    if (material.cohesion > 0) return refuse("material.cohesion_Pa");
    if (material.pore_pressure_ratio > 0) return refuse("material.pore_pressure_ratio");
    if (material.inertial_friction_coefficient) return refuse("material.inertial_friction_coefficient");
    for (std::size_t i = 0; i < scene.spec.releases.size(); ++i) {
        if (scene.spec.releases[i].pore_pressure_ratio.value_or(0) > 0) {
            return refuse(fmt::format("release[{}].pore_pressure_ratio", i));
        }
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
    for (std::size_t i = 0; i < scene.spec.zones.size(); ++i) {
        if (Status s = check_zone(scene, i); !s) return s.error();
    }
    if (Status s = check_material(scene); !s) return s.error();
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
