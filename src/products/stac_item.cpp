#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "geo/longitude_latitude.hpp"
#include "products/text_file.hpp"
#include "products/writers.hpp"

namespace talus::products {
namespace {

using Json = nlohmann::ordered_json;

struct FileKind {
    const char *ending, *type, *role;
};
constexpr std::array<FileKind, 12> file_kinds = {{
    {".tif", "image/tiff; application=geotiff; profile=cloud-optimized", "data"},
    {".gpkg", "application/geopackage+sqlite3", "data"},
    {".csv", "text/csv", "data"},
    {".nc", "application/netcdf", "data"},
    {".glb", "model/gltf-binary", "visual"},
    {".usda", "model/vnd.usda", "visual"},
    {".kml", "application/vnd.google-earth.kml+xml", "data"},
    {".json", "application/json", "metadata"},
    {".html", "text/html", "overview"},
    {".qml", "application/xml", "style"},
    {".qlr", "application/xml", "style"},
    {".txt", "text/plain", "metadata"},
}};

/// Files of the folder and of the run over time in it; not the parts of which ParaView makes a scene.
Json assets(const std::filesystem::path& folder) {
    std::set<std::string> names = {"manifest.json"};  // written last
    for (const char* part : {"", "series"}) {
        std::error_code failed;
        for (const auto& entry : std::filesystem::directory_iterator(folder / part, failed)) {
            if (!entry.is_regular_file(failed)) continue;
            names.insert((std::filesystem::path(part) / entry.path().filename()).generic_string());
        }
    }
    Json all = Json::object();
    for (const std::string& name : names) {
        const std::string ending = std::filesystem::path(name).extension().string();
        const auto kind = std::find_if(file_kinds.begin(), file_kinds.end(),
                                       [&](const FileKind& candidate) { return ending == candidate.ending; });
        if (kind != file_kinds.end()) {
            all[name] = {{"href", "./" + name}, {"type", kind->type}, {"roles", Json::array({kind->role})}};
        }
    }
    return all;
}

/// Sets geometry and bbox, in degrees, from the corners of the maps.
void set_place(Json& item, const geo::Crs& crs, const Extent& extent) {
    item["geometry"] = nullptr;
    const auto to_degrees = geo::to_wgs84(crs);
    if (!to_degrees) return;
    Json ring = Json::array();
    PlanPoint low{180, 90}, high{-180, -90};
    for (const PlanPoint corner : {PlanPoint{extent.x_min, extent.y_min}, PlanPoint{extent.x_max, extent.y_min},
                                   PlanPoint{extent.x_max, extent.y_max}, PlanPoint{extent.x_min, extent.y_max}}) {
        const PlanPoint p = (*to_degrees)(corner);
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
        ring.push_back({p.x, p.y});
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    ring.push_back(ring.front());
    item["geometry"] = {{"type", "Polygon"}, {"coordinates", Json::array({ring})}};
    item["bbox"] = {low.x, low.y, high.x, high.y};
}

}  // namespace

Status write_stac_item(const scene::Scene& scene, const run::RunResult& result, const std::filesystem::path& folder) {
    const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
    Json item = {{"type", "Feature"},
                 {"stac_version", "1.0.0"},
                 {"stac_extensions",
                  {"https://stac-extensions.github.io/projection/v2.0.0/schema.json",
                   "https://stac-extensions.github.io/processing/v1.1.0/schema.json"}},
                 {"id", "talus-" + to_hex(result.hash)}};
    set_place(item, scene.crs, result.observation.maps.peak_depth.geometry.extent());
    item["properties"] = {
        {"datetime", now},  // of the run: when debris flows like this, nobody knows
        {"title", title_of(scene, result)},
        {"description", scene.spec.scene.description.empty() ? scene.spec.scene.title : scene.spec.scene.description},
        {"proj:code", scene.crs.epsg > 0 ? Json(fmt::format("EPSG:{}", scene.crs.epsg)) : Json()},
        {"proj:wkt2", scene.crs.wkt},
        {"processing:software", {{"talus", TALUS_VERSION}}},
        {"talus:status", status_text(result.status)},
        {"talus:scene_hash", scene_hash(scene)},
        {"talus:result_hash", to_hex(result.hash)},
        {"talus:simulated_time_s", result.simulated_time}};
    item["links"] = Json::array();
    item["assets"] = assets(folder);
    // Names from attribute tables need not be valid UTF-8; the item is.
    return write_text_file(folder / "stac_item.json", item.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace talus::products
