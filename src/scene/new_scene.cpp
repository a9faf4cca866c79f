#include "scene/new_scene.hpp"

#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/coordinate_text.hpp"
#include "core/input_file.hpp"
#include "core/lower_case.hpp"
#include "core/try.hpp"
#include "geo/file_name.hpp"
#include "geo/mesh.hpp"
#include "geo/terrain_frame.hpp"
#include "geo/vector.hpp"
#include "params/scene_text.hpp"
#include "scene/check.hpp"
#include "scene/load.hpp"
#include "scene/new_release.hpp"
#include "scene/new_terrain.hpp"
#include "scene/reach.hpp"

namespace talus::scene {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> thickness_attributes = {"thickness_m", "thickness"};
const std::vector<std::string> height_attributes = {"height_m", "height"};

std::string absolute_name(const std::string& file) {
    if (file.empty() || geo::is_gdal_name(file)) return file;
    return fs::absolute(file).lexically_normal().string();
}

/// The path of the file as a scene in `folder` names it. Symbolic links are resolved, otherwise ".." would lead
/// elsewhere.
std::string name_from(const fs::path& folder, const std::string& file) {
    if (file.empty() || geo::is_gdal_name(file)) return file;
    const std::string on_disk = geo::file_on_disk(file), rest = file.substr(on_disk.size());
    std::error_code code;
    const fs::path from = fs::weakly_canonical(fs::absolute(folder), code), to = fs::weakly_canonical(on_disk, code);
    const fs::path relative = code ? fs::path() : to.lexically_relative(from);
    return relative.empty() ? file : relative.string() + rest;
}

/// The first of the names, in any case, that a feature has with a value, as the file spells it.
std::string find_attribute(const geo::PolygonLayer& layer, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        for (const geo::PolygonFeature& feature : layer.features) {
            for (const auto& [own, value] : feature.attributes) {
                if (lower_case(own) == name && !std::holds_alternative<std::monostate>(value)) return own;
            }
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
    if (const auto& e = options.extent; e && !(e->width() > 0 && e->height() > 0)) {
        return Error{
            fmt::format("extent {} {} {} {} is refused; it must be XMIN YMIN XMAX YMAX, with XMIN below XMAX "
                        "and YMIN below YMAX",
                        coordinate_text(e->x_min), coordinate_text(e->y_min), coordinate_text(e->x_max),
                        coordinate_text(e->y_max))};
    }
    return {};
}

/// A file that names its layer, and the layer that an option names; both may.
Result<geo::LayerOfFile> with_layer(const fs::path& file, const std::string& layer) {
    if (file.empty()) return geo::LayerOfFile{};
    TALUS_ASSIGN(geo::LayerOfFile named, geo::split_layer(file.string()));
    if (!layer.empty() && !named.layer.empty() && layer != named.layer) {
        return Error{
            fmt::format("{}: names the layer \"{}\", and the option \"{}\"", file.string(), named.layer, layer)};
    }
    named.file = absolute_name(named.file);
    if (!layer.empty()) named.layer = layer;
    return named;
}

/// The scene with absolute paths; thickness is settled once the release layer is known.
Result<ParsedScene> scene_from(const NewSceneOptions& options) {
    ParsedScene parsed;
    parsed.file = options.folder / "scene.toml";
    TALUS_ASSIGN(const geo::LayerOfFile dem, with_layer(options.dem, options.dem_layer));
    TALUS_ASSIGN(const geo::LayerOfFile scar, with_layer(options.release, options.release_layer));
    TALUS_ASSIGN(const geo::LayerOfFile houses, with_layer(options.buildings, ""));
    parsed.spec.terrain.file = dem.file + (dem.layer.empty() ? "" : "|layername=" + dem.layer);
    if (options.local) parsed.spec.terrain.crs = params::CrsChoice::local;
    parsed.spec.terrain.orthophoto = absolute_name(options.orthophoto.string());
    parsed.spec.buildings.file = houses.file;
    parsed.spec.buildings.layer = houses.layer;
    parsed.spec.scene.title = options.title;
    params::ReleaseSpec& release = parsed.spec.releases.emplace_back();
    release.file = scar.file;
    release.layer = scar.layer;
    release.thickness_raster = absolute_name(options.thickness_raster.string());
    release.name = fs::path(scar.file.empty() ? release.thickness_raster : scar.file).stem().string();
    release.thickness = options.thickness;
    release.volume = options.volume;
    if (options.target_particle_count) parsed.spec.solver.target_particle_count = *options.target_particle_count;
    for (const char* key : {"terrain.file", "terrain.orthophoto", "release[0].file", "release[0].thickness_raster",
                            "release[0].thickness_m", "release[0].volume_m3", "buildings.file"}) {
        parsed.places[key] = "new scene";
    }
    return parsed;
}

std::string attributes_text(const geo::PolygonLayer& layer) {
    std::string names;
    for (const auto& [name, value] : layer.features.front().attributes) names += (names.empty() ? "" : ", ") + name;
    return names.empty() ? "it has none" : "it has " + names;
}

Status choose_thickness(ParsedScene& parsed, const geo::PolygonLayer& layer) {
    params::ReleaseSpec& release = parsed.spec.releases.front();
    if (release.thickness || release.volume || !release.thickness_raster.empty()) return {};
    release.thickness_attribute = find_attribute(layer, thickness_attributes);
    if (!release.thickness_attribute.empty()) return {};
    return Error{fmt::format(
        "{}: how thick the release is, is not said: give its thickness, normal to the slope "
        "(--thickness-m M), or its volume (--volume-m3 M3), or its polygons an attribute {} (in any case; {})",
        release.file, fmt::join(thickness_attributes, " or "), attributes_text(layer))};
}

/// Where the release lies; of a raster of thickness, all of that.
Result<Extent> footprint_of(const ParsedScene& parsed, const geo::PolygonLayer& layer, const geo::TerrainFrame& frame) {
    const params::ReleaseSpec& release = parsed.spec.releases.front();
    Extent footprint;
    if (!release.file.empty()) {
        footprint = extent_of(layer.features.front().parts.front());
        for (const geo::PolygonFeature& feature : layer.features) {
            for (const Polygon& part : feature.parts) {
                const Extent e = extent_of(part);
                footprint.include({e.x_min, e.y_min});
                footprint.include({e.x_max, e.y_max});
            }
        }
    } else {
        const Result<geo::Raster> raster = read_value_raster(release.thickness_raster, frame.crs);
        if (!raster) return Error{parsed.at("release[0].thickness_raster") + ": " + raster.error().message};
        footprint = raster->grid.geometry.extent();
    }
    const Extent all = frame.geometry.extent().grown(-frame.geometry.cell / 2);
    const bool wholly = footprint.x_max < all.x_min || footprint.x_min > all.x_max || footprint.y_max < all.y_min ||
                        footprint.y_min > all.y_max;
    const bool reaches_beyond = footprint.x_min < all.x_min || footprint.x_max > all.x_max ||
                                footprint.y_min < all.y_min || footprint.y_max > all.y_max;
    if (wholly || (reaches_beyond && !release.file.empty())) {
        return Error{fmt::format(
            "{}: release \"{}\" {} the terrain: it covers {}, the terrain {} ({}); redraw the "
            "release or use a larger terrain",
            parsed.at(release.file.empty() ? "release[0].thickness_raster" : "release[0].file"), release.name,
            wholly ? "lies outside" : "reaches beyond", extent_text(footprint), extent_text(all), frame.crs.label())};
    }
    return footprint;
}

/// Heights and names of the buildings.
Status choose_attributes(ParsedScene& parsed, const geo::Crs& crs, std::vector<std::string>& notes) {
    params::BuildingsSpec& spec = parsed.spec.buildings;
    if (spec.file.empty() || geo::is_mesh_file(spec.file)) return {};
    const Result<geo::PolygonLayer> buildings = read_polygons(spec.file, spec.layer, crs);
    if (!buildings) return Error{"new scene: buildings.file: " + buildings.error().message};
    spec.height_attribute = find_attribute(*buildings, height_attributes);
    spec.name_attribute = find_attribute(*buildings, {"name"});
    if (spec.height_attribute.empty()) {
        notes.push_back(
            fmt::format("buildings: {} has no attribute {} ({}): all are taken to be {:.6g} m high "
                        "(buildings.default_height_m); buildings.height_attribute can name another",
                        spec.file, fmt::join(height_attributes, " or "), attributes_text(*buildings), spec.height));
    }
    return {};
}

/// The new folder, which is removed with what was written into it unless it is kept.
class NewFolder {
  public:
    NewFolder(fs::path folder, bool exists) : folder_(std::move(folder)), is_ours_(!exists) {}
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;
    ~NewFolder() {
        std::error_code code;
        if (is_ours_ && made_ && !kept_) fs::remove_all(folder_, code);
    }
    [[nodiscard]] Status make() {
        std::error_code code;
        made_ = fs::create_directories(folder_, code) || made_;
        if (code) return Error{fmt::format("{}: cannot be made: {}", folder_.string(), code.message())};
        return {};
    }
    void keep() { kept_ = true; }

  private:
    const fs::path folder_;
    const bool is_ours_;
    bool made_ = false, kept_ = false;
};

Status write_file(const fs::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.close();
    if (out) return {};
    std::error_code code;
    fs::remove(file, code);
    return Error{fmt::format("{}: cannot be written; is the disk full?", file.string())};
}

/// Writes the terrain on coarser cells into the new folder, and names that.
Status write_coarse_terrain(ParsedScene& parsed, const fs::path& folder, int factor, std::vector<std::string>& notes) {
    params::TerrainSpec& spec = parsed.spec.terrain;
    const auto raster =
        geo::read_coarse_terrain(spec.file, spec.band, spec.extent, factor, spec.crs == params::CrsChoice::local);
    if (!raster) return Error{parsed.at("terrain.file") + ": " + raster.error().message};
    const fs::path file = fs::absolute(folder) / "terrain.tif";
    const std::string unit = raster->vertical_unit == "not stated" ? "" : raster->vertical_unit;
    TALUS_TRY(geo::write_cog(file.string(), {&raster->grid, "elevation", unit}, raster->crs));
    notes.push_back(fmt::format("terrain: {} holds means of {} x {} cells of {}", file.filename().string(), factor,
                                factor, spec.file));
    spec.file = file.lexically_normal().string();
    spec.extent.reset();
    return {};
}

}  // namespace

Result<NewScene> write_new_scene(const NewSceneOptions& options) {
    TALUS_TRY(check_options(options));
    TALUS_ASSIGN(ParsedScene parsed, scene_from(options));
    params::TerrainSpec& terrain = parsed.spec.terrain;
    params::ReleaseSpec& release = parsed.spec.releases[0];
    std::vector<std::string> notes;
    NewFolder folder(options.folder, options.folder_exists);

    const auto frame = geo::read_terrain_frame(terrain.file, terrain.band, options.local);
    if (!frame) return Error{parsed.at("terrain.file") + ": " + frame.error().message};
    int factor = 1;
    if (options.cell) {
        TALUS_ASSIGN(factor, coarsening(terrain.file, *frame, *options.cell));
    }
    geo::PolygonLayer layer;
    if (!release.file.empty()) {
        auto read = read_polygons(release.file, release.layer, frame->crs);
        if (!read) return Error{"new scene: release[0].file: " + read.error().message};
        layer = std::move(*read);
        if (!options.release_feature.empty()) {
            TALUS_TRY(choose_features(release.file, options.release_feature, layer));
            TALUS_TRY(folder.make());
            TALUS_TRY(write_features(layer, frame->crs, options.folder, release));
            notes.push_back(fmt::format("release: {} holds {} of the features of {}",
                                        fs::path(release.file).filename().string(), layer.features.size(),
                                        options.release.string()));
        }
    }
    TALUS_ASSIGN(const Extent footprint, footprint_of(parsed, layer, *frame));
    if (!release.file.empty()) TALUS_TRY(choose_thickness(parsed, layer));
    if (options.extent) {
        terrain.extent = options.extent;
    } else {
        TALUS_ASSIGN(terrain.extent, choose_extent(parsed, *frame, footprint, factor));
        notes.push_back(
            fmt::format("terrain: the extent holds all ground below an energy line of {:.0f} degrees from the release, "
                        "and a margin",
                        travel_angle_deg));
    }
    TALUS_TRY(choose_attributes(parsed, frame->crs, notes));
    if (factor > 1) {
        TALUS_TRY(folder.make());
        TALUS_TRY(write_coarse_terrain(parsed, options.folder, factor, notes));
        Scene noted;
        note_terrain_file(*frame, noted);
        notes.insert(notes.end(), noted.notes.begin(), noted.notes.end());
    }
    // As a run would load it: everything is checked before writing.
    TALUS_ASSIGN(Scene scene, assemble_scene(parsed));

    params::SceneSpec spec = parsed.spec;
    spec.scene.title = scene.spec.scene.title;
    spec.terrain.file = name_from(options.folder, spec.terrain.file);
    spec.buildings.file = name_from(options.folder, spec.buildings.file);
    spec.terrain.orthophoto = name_from(options.folder, spec.terrain.orthophoto);
    spec.releases[0].file = name_from(options.folder, spec.releases[0].file);
    spec.releases[0].thickness_raster = name_from(options.folder, spec.releases[0].thickness_raster);
    std::string header =
        "A scene for talus. Lines that begin with # are explanations and default values: remove the # from a value to "
        "change it; instead of none, write a value. Paths are relative to this file. These are the keys that matter "
        "first; talus scene reference has all, such as those of barriers, inflows, beds, zones and observations.";
    if (!options.extent) {
        header += fmt::format(
            "\n\nThe terrain's part holds all ground that lies below an energy line of {:.0f} degrees "
            "from the release, and a margin.",
            travel_angle_deg);
    }
    NewScene made{options.folder / "scene.toml", std::move(notes), {}};
    made.notes.insert(made.notes.end(), scene.notes.begin(), scene.notes.end());
    scene.notes.clear();
    made.summary = describe_scene(scene);
    TALUS_TRY(folder.make());
    TALUS_TRY(write_file(made.file, write_short_scene(spec, header)));
    folder.keep();
    return made;
}

}  // namespace talus::scene
