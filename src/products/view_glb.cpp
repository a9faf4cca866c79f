#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/try.hpp"
#include "geo/earth_fixed.hpp"
#include "products/glb.hpp"
#include "products/text_file.hpp"
#include "products/view.hpp"
#include "products/writers.hpp"
#include "report/hazard_map.hpp"

namespace talus::products {
namespace {

using Json = nlohmann::ordered_json;

constexpr double hold = 2;  // s, for which the deposit is seen before the animation begins again

Json about(const View& view) {
    const WorldPoint origin = view.scene.terrain.frame().origin;
    Json all = Json::object();
    for (const auto& [key, value] : plain_origin_of(view.scene, view.result)) all[key] = value;
    all["reference_system"] = view.scene.crs.label();
    all["origin_m"] = {origin.x, origin.y, origin.z};
    all["axes"] = "x east, y up, z south of origin_m, in metres";
    all["colours_of_debris"] = fmt::format("speed, from light (0) to dark ({:.3g} m/s)", view.greatest_speed());
    return all;
}

}  // namespace

Status write_glb(const View& view, const std::filesystem::path& file) {
    Glb glb(title_of(view.scene, view.result), "talus " TALUS_VERSION, about(view));
    constexpr report::Colour white{255, 255, 255};
    const std::size_t ground = glb.add({"ground", ground_colour, 1, true});
    const std::size_t wall = glb.add({"structures", white, 0.9, true});
    const std::size_t debris = glb.add({"debris", white, 0.7, true});
    glb.add("terrain", view.surface.ground(), ground);
    TriangleMesh structures;
    for (View::Structure& structure : view.structures()) {
        structure.mesh.colours.assign(structure.mesh.points.size(), structure.colour);
        structures.add(structure.mesh);
    }
    glb.add("structures", structures, wall);

    const auto& animated = view.surface.animated();
    const double end = view.times.back() + hold;
    for (std::size_t k = 0; k < animated.size(); ++k) {
        TALUS_ASSIGN(DebrisMesh mesh, view.surface.debris(animated[k]));
        mesh.colours = view.speed_colours(mesh.speed);
        const bool last = k + 1 == animated.size();
        const double from = view.times[animated[k]];
        glb.add(fmt::format("debris at {:.4g} s", from), mesh, debris,
                {from, last ? end : view.times[animated[k + 1]], end, last});
    }
    return glb.write(file);
}

Status write_tileset(const View& view, const std::filesystem::path& file, const std::string& glb) {
    WorldPoint origin = view.scene.terrain.frame().origin;
    const WorldPoint local = origin;
    origin.z += view.scene.spec.outputs.geoid_height.value_or(0);
    TALUS_ASSIGN(const geo::EarthFixed place, geo::earth_fixed(view.scene.crs, origin));
    Json transform = Json::array();
    for (const auto& [axis, last] : {std::pair{place.east, 0}, {place.north, 0}, {place.up, 0}, {place.origin, 1}}) {
        for (const double value : axis) transform.push_back(value);
        transform.push_back(last);
    }
    // A box around what is drawn; tiles are z up, and turn what is in a glTF file from y up.
    const Extent extent = view.surface.lattice().extent();
    double low = view.surface.lowest(), high = view.surface.highest();
    for (const View::Structure& structure : view.structures()) {
        for (const LocalPoint& p : structure.mesh.points) {
            low = std::min<double>(low, p.z);
            high = std::max<double>(high, p.z);
        }
    }
    high += 1 + report::greatest(view.result.observation.maps.peak_depth);
    const std::array<double, 12> box = {(extent.x_min + extent.x_max) / 2 - local.x,
                                        (extent.y_min + extent.y_max) / 2 - local.y,
                                        (low + high) / 2,
                                        extent.width() / 2,
                                        0,
                                        0,
                                        0,
                                        extent.height() / 2,
                                        0,
                                        0,
                                        0,
                                        (high - low) / 2};
    const Json tileset = {{"asset", {{"version", "1.1"}, {"extras", about(view)}}},
                          {"geometricError", extent.width() + extent.height()},
                          {"root",
                           {{"boundingVolume", {{"box", box}}},
                            {"geometricError", 0},
                            {"refine", "ADD"},
                            {"transform", transform},
                            {"content", {{"uri", glb}}}}}};
    return write_text_file(file, tileset.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace talus::products
