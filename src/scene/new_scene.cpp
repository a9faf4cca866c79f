#include "scene/new_scene.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/input_file.hpp"
#include "core/try.hpp"
#include "geo/mesh.hpp"
#include "geo/vector.hpp"
#include "params/scene_text.hpp"
#include "scene/check.hpp"
#include "scene/load.hpp"
#include "scene/reach.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;

/// Lower than the travel angles of observed hillslope and channelised debris flows: the ground outside is not reached.
constexpr double travel_angle_deg = 11;
constexpr double assumed_thickness = 2;  // m

std::string absolute_name(const fs::path& file) {
    if (file.empty() || file.string().rfind("/vsi", 0) == 0) return file.string();
    return fs::absolute(file).lexically_normal().string();
}

/// The path of the file as a scene in `folder` names it. Symbolic links are resolved, otherwise ".." would lead
/// elsewhere.
std::string name_from(const fs::path& folder, const std::string& file) {
    if (file.empty() || file.rfind("/vsi", 0) == 0) return file;
    std::error_code code;
    const fs::path from = fs::weakly_canonical(fs::absolute(folder), code), to = fs::weakly_canonical(file, code);
    const fs::path relative = code ? fs::path() : to.lexically_relative(from);
    return relative.empty() ? file : relative.string();
}

/// The first of the names that all features have, with a value in at least one of them.
std::string find_attribute(const geo::PolygonLayer& layer, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        for (const geo::PolygonFeature& feature : layer.features) {
            const auto found = feature.attributes.find(name);
            if (found != feature.attributes.end() && !std::holds_alternative<std::monostate>(found->second))
                return name;
        }
    }
    return "";
}

Status check_number(const std::string& section, const std::string& key, const std::string& option,
                    const params::ParameterValue& value) {
    const std::string problem = problem_with(*params::find_section(section)->find(key), value);
    if (problem.empty()) return {};
    return Error{fmt::format("{} {} is refused; it must be {}", option, params::plain_text(value), problem)};
}

Status check_options(const NewSceneOptions& options) {
    std::error_code code;
    for (const fs::path& input :
         {options.dem, options.release, options.thickness_raster, options.buildings, options.orthophoto}) {
        TALUS_TRY(check_input_file(input));
    }
    if (options.folder.empty()) return Error{"the folder for the new scene has no name"};
    if (!options.folder_exists && fs::exists(fs::symlink_status(options.folder, code))) {
        return Error{options.folder.string() + ": is already there; name a folder that is not"};
    }
    if (options.thickness && options.volume) {
        return Error{fmt::format("thickness {:.6g} m and volume {:.6g} m3 are both given; give one of them",
                                 *options.thickness, *options.volume)};
    }
    if (options.thickness) {
        TALUS_TRY(check_number("release", "thickness_m", "thickness", *options.thickness));
    }
    if (options.volume) {
        TALUS_TRY(check_number("release", "volume_m3", "volume", *options.volume));
    }
    if (options.target_particle_count) {
        const std::int64_t count = *options.target_particle_count;
        TALUS_TRY(check_number("solver", "target_particle_count", "target particle count", count));
    }
    return {};
}

/// The scene with absolute paths; thickness is settled once the release layer is known.
ParsedScene scene_from(const NewSceneOptions& options) {
    ParsedScene parsed;
    parsed.file = options.folder / "scene.toml";
    parsed.spec.terrain.file = absolute_name(options.dem);
    if (options.local) parsed.spec.terrain.crs = params::CrsChoice::local;
    parsed.spec.terrain.orthophoto = absolute_name(options.orthophoto);
    parsed.spec.buildings.file = absolute_name(options.buildings);
    parsed.spec.scene.title = options.title;
    params::ReleaseSpec& release = parsed.spec.releases.emplace_back();
    release.file = absolute_name(options.release);
    release.thickness_raster = absolute_name(options.thickness_raster);
    release.name = (options.release.empty() ? options.thickness_raster : options.release).stem().string();
    release.thickness = options.thickness;
    release.volume = options.volume;
    if (options.target_particle_count) parsed.spec.solver.target_particle_count = *options.target_particle_count;
    for (const char* key : {"terrain.file", "terrain.orthophoto", "release[0].file", "release[0].thickness_raster",
                            "release[0].thickness_m", "release[0].volume_m3", "buildings.file"}) {
        parsed.places[key] = "new scene";
    }
    return parsed;
}

Status choose_thickness(ParsedScene& parsed, const geo::PolygonLayer& layer) {
    params::ReleaseSpec& release = parsed.spec.releases.front();
    if (release.thickness || release.volume) return {};
    release.thickness_attribute = find_attribute(layer, {"thickness_m", "thickness"});
    if (!release.thickness_attribute.empty()) return {};
    release.thickness = assumed_thickness;
    parsed.spec.scene.assumptions.push_back(fmt::format(
        "The release is {:.6g} m thick, measured normal to the slope: no thickness and no volume was given.",
        assumed_thickness));
    return {};
}

/// The reachable ground and a margin, in whole cells of the terrain.
Extent choose_extent(const Scene& scene) {
    const GridGeometry& g = scene.terrain.elevation().geometry;
    const double margin = std::max(50.0, 10 * g.cell);
    const Extent reach =
        reachable_extent(scene.terrain, scene.releases, travel_angle_deg * std::numbers::pi / 180).grown(margin);
    const Extent all = g.extent();
    const auto down = [&](double value, double edge) { return edge + g.cell * std::floor((value - edge) / g.cell); };
    const auto up = [&](double value, double edge) { return edge + g.cell * std::ceil((value - edge) / g.cell); };
    return {std::max(all.x_min, down(reach.x_min, g.x_min)), std::max(all.y_min, down(reach.y_min, g.y_min)),
            std::min(all.x_max, up(reach.x_max, g.x_min)), std::min(all.y_max, up(reach.y_max, g.y_min))};
}

Status write_file(const fs::path& folder, const fs::path& file, const std::string& text) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) return Error{fmt::format("{}: cannot be made: {}", folder.string(), code.message())};
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (out) return {};
    fs::remove(file, code);
    fs::remove(folder, code);
    return Error{fmt::format("{}: cannot be written; is the disk full?", file.string())};
}

}  // namespace

Result<NewScene> write_new_scene(const NewSceneOptions& options) {
    TALUS_TRY(check_options(options));
    ParsedScene parsed = scene_from(options);

    Scene whole;
    whole.spec = parsed.spec;
    TALUS_TRY(load_terrain(parsed, whole));
    if (!options.release.empty()) {
        const Result<geo::PolygonLayer> layer = read_polygons(parsed.spec.releases[0].file, "", whole.crs);
        if (!layer) return Error{"new scene: release[0].file: " + layer.error().message};
        TALUS_TRY(choose_thickness(parsed, *layer));
    }
    whole.spec.releases = parsed.spec.releases;
    TALUS_TRY(load_releases(parsed, whole));
    parsed.spec.terrain.extent = choose_extent(whole);
    if (!options.buildings.empty() && !geo::is_mesh_file(options.buildings.string())) {
        const Result<geo::PolygonLayer> buildings = read_polygons(parsed.spec.buildings.file, "", whole.crs);
        if (!buildings) return Error{"new scene: buildings.file: " + buildings.error().message};
        parsed.spec.buildings.height_attribute = find_attribute(*buildings, {"height_m", "height"});
        parsed.spec.buildings.name_attribute = find_attribute(*buildings, {"name"});
    }
    whole = {};
    // As a run would load it: everything is checked before writing.
    TALUS_ASSIGN(Scene scene, assemble_scene(parsed));

    params::SceneSpec spec = parsed.spec;
    spec.scene.title = scene.spec.scene.title;
    spec.terrain.file = name_from(options.folder, spec.terrain.file);
    spec.buildings.file = name_from(options.folder, spec.buildings.file);
    spec.terrain.orthophoto = name_from(options.folder, spec.terrain.orthophoto);
    spec.releases[0].file = name_from(options.folder, spec.releases[0].file);
    spec.releases[0].thickness_raster = name_from(options.folder, spec.releases[0].thickness_raster);
    const std::string extent_note = fmt::format(
        "terrain: the extent holds all ground below an energy line of {:.0f} degrees from the release, and a margin",
        travel_angle_deg);
    const std::string header =
        "A scene for talus. Lines that begin with # are explanations and default values: remove the # from a value to "
        "change it. Paths are relative to this file. These are the keys that matter first; talus scene reference has "
        "all, such as those of barriers, inflows, beds, zones and observations.\n\nterrain.extent_m holds all ground "
        "that lies below an energy "
        "line of " +
        fmt::format("{:.0f}", travel_angle_deg) + " degrees from the release, and a margin.";
    NewScene made{options.folder / "scene.toml", std::exchange(scene.notes, {}), {}};
    made.summary = describe_scene(scene);
    made.notes.insert(made.notes.begin(), extent_note);
    for (const std::string& assumption : spec.scene.assumptions) made.notes.push_back("assumed: " + assumption);
    TALUS_TRY(write_file(options.folder, made.file, write_short_scene(spec, header)));
    return made;
}

}  // namespace talus::scene
