#include "scene/output_defaults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/decimals.hpp"
#include "geo/geoid.hpp"
#include "params/fields.hpp"

namespace talus::scene {

double output_scale(double path_length) {
    constexpr double smallest = 0.001;
    if (!(path_length > 0) || path_length >= shortest_field_path) return 1;
    const double share = path_length / shortest_field_path;
    const double power = std::pow(10, std::floor(std::log10(share)));
    const double digit = share / power;
    // The bounds are the geometric means of 1, 2, 5 and 10.
    const double round = digit > std::sqrt(50) ? 10 : digit > std::sqrt(10) ? 5 : digit > std::sqrt(2) ? 2 : 1;
    return std::max(smallest, round * power);
}

void shorten_outputs(Scene& scene) {
    if (scene.flow_path.empty()) return;
    const double scale = output_scale(scene.flow_path.length());
    if (scale >= 1) return;
    struct Length {
        const char* key;
        double params::OutputSpec::*value;
        double least;  // m, as the key allows
    };
    constexpr std::array lengths = {
        Length{"chainage_interval_m", &params::OutputSpec::chainage_interval, 0.001},
        Length{"front_velocity_window_m", &params::OutputSpec::front_velocity_window, 0.001},
        Length{"arrival_depth_m", &params::OutputSpec::arrival_depth, 0},
        Length{"impact_patch_edge_m", &params::OutputSpec::impact_patch_edge, 0.1}};
    std::string changed;
    for (const Length& length : lengths) {
        if (scene.given_keys.contains(std::string("outputs.") + length.key)) continue;
        double& value = scene.spec.outputs.*length.value;
        value = std::max(length.least, scale * value);
        changed += fmt::format("{}{} = {:.3g}", changed.empty() ? "" : ", ", length.key, value);
    }
    if (changed.empty()) return;
    const double path = scene.flow_path.length();
    scene.notes.push_back(
        fmt::format("outputs: {}, as suits a flow path of {:.{}f} m", changed, path, decimals_for(path, 0)));
}

void settle_geoid_height(Scene& scene) {
    params::OutputSpec& outputs = scene.spec.outputs;
    const bool on_globe = std::find(outputs.series.begin(), outputs.series.end(), "3dtiles") != outputs.series.end();
    if (!on_globe || outputs.geoid_height) return;
    const WorldPoint origin = scene.terrain.frame().origin;
    const auto found = geo::geoid_height(scene.crs, {origin.x, origin.y});
    if (!found) {
        scene.notes.emplace_back(
            "3dtiles: PROJ has no geoid grid here, so that heights are taken to count from the ellipsoid of WGS 84, "
            "tens "
            "of metres from the sea in most places; set outputs.geoid_height_m");
        return;
    }
    outputs.geoid_height = found->height;
    scene.notes.push_back(fmt::format(
        "3dtiles: heights are taken to count from the sea, which lies {:.2f} m above the ellipsoid of WGS 84 "
        "here by {}; outputs.geoid_height_m says otherwise",
        found->height, found->model));
}

}  // namespace talus::scene
