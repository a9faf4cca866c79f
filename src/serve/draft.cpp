#include "serve/draft.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/try.hpp"
#include "geo/vector.hpp"
#include "scene/check.hpp"
#include "scene/load.hpp"
#include "serve/library.hpp"

namespace talus::serve {
namespace {

namespace fs = std::filesystem;

constexpr int most_scenes_of_a_name = 1000;

/// Lowest and highest, m, by which a person sees whether feet were taken for metres.
std::optional<std::array<double, 2>> elevation_range(const Grid<float>& grid) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const float value : grid.values) {
        if (!std::isfinite(value)) continue;
        low = std::min(low, double{value});
        high = std::max(high, double{value});
    }
    return low <= high ? std::optional(std::array{low, high}) : std::nullopt;
}

}  // namespace

Result<Draft> Draft::make(fs::path folder, const UploadLimits& limits) {
    std::error_code error;
    fs::create_directories(folder / "data", error);
    if (error) return Error{fmt::format("{}: cannot be made: {}", folder.string(), error.message())};
    return Draft(std::move(folder), limits);
}

Draft::~Draft() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

Draft::Draft(Draft&& other) noexcept
    : folder_(std::exchange(other.folder_, {})),
      limits_(other.limits_),
      uploads_(std::move(other.uploads_)),
      mending_(other.mending_),
      facts_(std::move(other.facts_)),
      terrain_(std::move(other.terrain_)),
      problem_(std::move(other.problem_)) {}

const Draft::Upload* Draft::find(std::string_view role) const {
    const auto found = uploads_.find(role);
    return found == uploads_.end() ? nullptr : &found->second;
}

Status Draft::take(std::string_view role, const std::string& name, const fs::path& upload,
                   const geo::ForeignReader& reader) {
    const fs::path place = folder_ / "data" / role, fresh = folder_ / "fresh";
    std::error_code ignored;
    const auto without = [&](const Error& error) {
        fs::remove_all(fresh, ignored);
        fs::remove_all(folder_ / "foreign", ignored);
        fs::remove(upload, ignored);
        // By the name that its user gave it.
        std::string message = plain(error.message);
        const std::string kept = upload_name_of(name);
        if (message.starts_with(kept + ":")) message.replace(0, kept.size(), name);
        return Error{std::move(message)};
    };
    auto made = convert(role, name, upload, fresh, reader);
    if (!made) return without(made.error());
    std::error_code error;
    fs::remove_all(place, ignored);
    fs::rename(fresh, place, error);
    if (error) return without(Error{name + ": cannot be kept: " + error.message()});
    fs::remove(upload, ignored);
    made->file = place / made->file.lexically_relative(fresh);
    uploads_[std::string(role)] = std::move(*made);
    if (role == "terrain") {
        mending_ = {};
        fs::remove(folder_ / "data" / "terrain.tif", ignored);
        read_terrain();
    }
    return {};
}

void Draft::remove(std::string_view role) {
    std::error_code ignored;
    const auto found = uploads_.find(role);
    if (found == uploads_.end()) return;
    uploads_.erase(found);
    fs::remove_all(folder_ / "data" / role, ignored);
    if (role != "terrain") return;
    fs::remove(folder_ / "data" / "terrain.tif", ignored);
    mending_ = {};
    facts_.reset();
    terrain_.reset();
    problem_.clear();
}

fs::path Draft::dem() const {
    const Upload* upload = find("terrain");
    return mending_.any() ? folder_ / "data" / "terrain.tif" : upload != nullptr ? upload->file : fs::path();
}

void Draft::read_terrain() {
    terrain_.reset();
    problem_.clear();
    auto facts = geo::raster_facts(dem().string());
    facts_ = facts ? std::optional(*facts) : std::nullopt;
    auto raster = geo::read_terrain_raster(dem().string(), 1, std::nullopt);
    if (raster) {
        terrain_ = std::move(*raster);
    } else {
        problem_ = plain(raster.error().message);
    }
}

Status Draft::mend(const geo::Mending& mending) {
    const Upload* upload = find("terrain");
    if (upload == nullptr) return Error{"there is no terrain yet"};
    if (mending.local) {
        const auto facts = geo::raster_facts(upload->file.string());
        if (facts && !facts->crs.empty()) {
            return Error{fmt::format("local = true; the terrain states a reference system, {}", facts->crs)};
        }
    }
    const fs::path mended = folder_ / "data" / "terrain.tif", fresh = folder_ / "fresh.tif";
    std::error_code error;
    if (mending.any()) {
        if (Status done = geo::repair_raster(upload->file.string(), fresh.string(), mending, limits_.cells); !done) {
            return Error{plain(done.error().message)};
        }
        fs::rename(fresh, mended, error);
        if (error) return Error{"the mended terrain cannot be kept: " + error.message()};
    } else {
        fs::remove(mended, error);
    }
    mending_ = mending;
    read_terrain();
    return {};
}

messages::Draft Draft::describe() const {
    messages::Draft told{.files = {}, .terrain = {}, .bytes_left = bytes_left()};
    for (const auto& [role, upload] : uploads_) {
        told.files.insert({role,
                           {.name = upload.name,
                            .bytes = upload.bytes,
                            .kind = upload.kind == geo::FileKind::raster   ? "raster"
                                    : upload.kind == geo::FileKind::vector ? "polygons"
                                                                           : "other"}});
    }
    if (find("terrain") == nullptr) return told;
    const geo::RasterFacts facts = facts_.value_or(geo::RasterFacts{});
    std::optional<messages::Integer> epsg;
    if (mending_.epsg != 0) epsg = mending_.epsg;
    messages::DraftTerrain terrain{.problem = messages::if_any(problem_),
                                   .columns = facts.columns,
                                   .rows = facts.rows,
                                   .crs = facts.crs,
                                   .metric_crs = facts.metric_crs,
                                   .value_unit = facts.value_unit,
                                   .height_unit_m = facts.height_unit,
                                   .mending = {.epsg = epsg,
                                               .local = mending_.local,
                                               .metric = mending_.metric,
                                               .metres_per_unit = mending_.metres_per_unit,
                                               .nodata = mending_.nodata}};
    if (terrain_) {
        const GridGeometry& g = terrain_->grid.geometry;
        terrain.cell_m = g.cell;
        terrain.columns = g.columns;
        terrain.rows = g.rows;
        terrain.crs = terrain_->crs.label();
        terrain.nodata_share = terrain_->nodata_share;
        terrain.elevation_m.emplace(elevation_range(terrain_->grid));
    }
    told.terrain = std::move(terrain);
    return told;
}

std::string Draft::plain(std::string message) const {
    for (const std::string& role :
         {std::string("/data/terrain"), std::string("/data/release"), std::string("/data/buildings"),
          std::string("/data/orthophoto"), std::string("/data/drawn"), std::string("/data"), std::string("/fresh"),
          std::string("/foreign"), std::string()}) {
        const std::string part = folder_.string() + role + "/";
        for (std::size_t at; (at = message.find(part)) != std::string::npos;) message.erase(at, part.size());
    }
    for (const char* command : {": gdal", "new scene: terrain.file: ", "new scene: terrain.orthophoto: ",
                                "new scene: release[0].file: ", "new scene: buildings.file: "}) {
        const std::size_t at = message.find(command);
        if (at == std::string::npos) continue;
        if (*command == ':') {
            message.resize(at);
        } else {
            message.erase(at, std::string_view(command).size());
        }
    }
    return message;
}

/// Writes the scene file into the folder. What of the files it does not need stays.
Result<scene::NewScene> Draft::write_scene(const Wanted& wanted) {
    const Upload *terrain = find("terrain"), *release = find("release"), *buildings = find("buildings"),
                 *photo = find("orthophoto");
    if (terrain == nullptr) return Error{"a terrain is needed"};
    if (!terrain_) return Error{problem_};
    if (release == nullptr && wanted.scar.empty()) {
        return Error{"a release is needed: a file of it, or its outline drawn on the hillshade"};
    }
    scene::NewSceneOptions options;
    options.dem = dem();
    options.local = terrain_->crs.local;
    options.title = wanted.title;
    options.folder = folder_;
    options.folder_exists = true;
    if (buildings != nullptr) options.buildings = buildings->file;
    if (photo != nullptr) options.orthophoto = photo->file;
    const bool raster = wanted.scar.empty() && release->kind == geo::FileKind::raster;
    if (!raster) {
        options.thickness = wanted.thickness;
        options.volume = wanted.volume;
    } else if (wanted.thickness || wanted.volume) {
        return Error{"the release is a raster, which holds its own thickness; leave thickness and volume out"};
    }
    if (!wanted.scar.empty()) {
        if (!wanted.thickness && !wanted.volume) {
            return Error{
                "how thick the release is, is not said: give its thickness, normal to the slope, or its volume"};
        }
        const fs::path drawn = folder_ / "data" / "drawn" / "scar.gpkg";
        std::error_code error;
        fs::remove_all(drawn.parent_path(), error);
        fs::create_directories(drawn.parent_path(), error);
        geo::OutputFeature scar;
        scar.polygon.push_back({wanted.scar, {}});
        scar.values.emplace_back("scar");
        TALUS_TRY(geo::write_geopackage_layer(drawn.string(), "release", {{"name", true}}, {scar}, terrain_->crs));
        options.release = drawn;
    } else if (raster) {
        options.thickness_raster = release->file;
    } else {
        options.release = release->file;
    }
    auto made = scene::write_new_scene(options);
    if (!made) return Error{plain(made.error().message)};
    for (std::string& note : made->notes) note = plain(note);
    return made;
}

Result<scene::NewScene> Draft::check_bundle() const {
    const fs::path& file = find("bundle")->file;
    auto loaded = scene::load_scene(file);
    if (!loaded) return Error{plain(loaded.error().message)};
    scene::NewScene made{file, std::exchange(loaded->notes, {}), {}};
    made.summary = scene::describe_scene(*loaded);
    for (std::string& note : made.notes) note = plain(note);
    return made;
}

Result<scene::NewScene> Draft::check(const Wanted& wanted) {
    if (find("bundle") != nullptr) return check_bundle();
    auto made = write_scene(wanted);
    std::error_code ignored;
    fs::remove(folder_ / "scene.toml", ignored);
    fs::remove_all(folder_ / "data" / "drawn", ignored);
    return made;
}

Result<fs::path> Draft::finish(const Wanted& wanted, const fs::path& scenes) {
    const Upload* bundle = find("bundle");
    TALUS_ASSIGN(const auto made, bundle != nullptr ? check_bundle() : write_scene(wanted));
    std::error_code error;
    const fs::path from = bundle != nullptr ? made.file.parent_path() : folder_;
    if (bundle != nullptr) {
        fs::rename(made.file, from / "scene.toml", error);
    } else {
        if (mending_.any()) fs::remove_all(folder_ / "data" / "terrain", error);
        if (!wanted.scar.empty()) fs::remove_all(folder_ / "data" / "release", error);
    }
    fs::create_directories(scenes, error);
    std::string name =
        file_name_of(wanted.title.empty() && bundle != nullptr ? fs::path(bundle->name).stem().string() : wanted.title);
    if (name.empty()) name = "scene";
    for (int k = 1; k < most_scenes_of_a_name; ++k) {
        const fs::path to = scenes / (k == 1 ? name : fmt::format("{}-{}", name, k));
        if (fs::exists(fs::symlink_status(to, error))) continue;
        fs::rename(from, to, error);
        if (error) break;
        fs::remove_all(folder_, error);  // of a bundle: what is around it
        folder_.clear();
        return to / "scene.toml";
    }
    fs::remove(folder_ / "scene.toml", error);
    return Error{fmt::format("{}: the scene cannot be kept there; is the disk full?", scenes.string())};
}

}  // namespace talus::serve
