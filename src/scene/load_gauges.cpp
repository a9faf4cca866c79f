#include <cmath>

#include <fmt/format.h>

#include "scene/load.hpp"

namespace talus::scene {

Status load_gauges(const ParsedScene& parsed, Scene& scene) {
    for (std::size_t i = 0; i < scene.spec.gauges.size(); ++i) {
        const params::GaugeSpec& spec = scene.spec.gauges[i];
        const std::string key = fmt::format("gauge[{}].{}", i, spec.chainage ? "chainage_m" : "x_m");
        terrain::Gauge gauge;
        gauge.name = spec.name.empty() ? fmt::format("gauge {}", i + 1) : spec.name;
        if (spec.chainage) {
            if (scene.flow_path.empty() || *spec.chainage > scene.flow_path.length()) {
                return Error{fmt::format("{} = {:.6g} lies beyond the flow path, which is {:.1f} m long",
                                         parsed.at(key), *spec.chainage, scene.flow_path.length())};
            }
            gauge.chainage = *spec.chainage;
            gauge.at = scene.flow_path.point_at(gauge.chainage);
        } else {
            gauge.at = {spec.x.value(), spec.y.value()};
        }
        if (std::isnan(scene.terrain.elevation_at(gauge.at))) {
            return Error{fmt::format("{}: {} is not on the terrain, {}", parsed.at(key), place_text(gauge.at),
                                     extent_text(covered_extent(scene.terrain)))};
        }
        for (const terrain::Gauge& other : scene.gauges) {
            if (other.name != gauge.name) continue;
            return Error{fmt::format("{} = \"{}\" is the name of another gauge too",
                                     parsed.at(fmt::format("gauge[{}].name", i)), one_line(gauge.name, 80))};
        }
        scene.gauges.push_back(std::move(gauge));
    }
    return {};
}

}  // namespace talus::scene
