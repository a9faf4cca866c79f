#include <algorithm>
#include <limits>
#include <vector>

#include "report/results.hpp"

namespace talus::report {
namespace {

/// Released volume and volume eroded upstream, against chainage.
Json erosion_chart(const run::RunResult& result) {
    const observe::Erosion& erosion = result.observation.erosion;
    if (erosion.chainage.empty() || !(erosion.volume > 0)) return {};
    // To slightly beyond the last increase of the volume.
    const auto last = std::find_if(erosion.upstream.begin(), erosion.upstream.end(),
                                   [&](double v) { return v >= erosion.upstream.back(); });
    const double end = std::min(erosion.chainage.back(),
                                1.1 * erosion.chainage[static_cast<std::size_t>(last - erosion.upstream.begin())] + 1);
    ValueRange volumes{0, 1};
    std::vector<double> volume(erosion.upstream.size());
    for (std::size_t k = 0; k < volume.size(); ++k) {
        volume[k] = erosion.chainage[k] <= end ? result.observation.volume_released + erosion.upstream[k]
                                               : std::numeric_limits<double>::quiet_NaN();
        volumes.include(volume[k]);
    }
    volumes.high *= 1.08;
    Plot plot(66, 34, 916, 240, {0, end}, volumes);
    plot.axes("chainage along the flow path, m", "volume, m³");
    plot.horizontal(result.observation.volume_released, "limit blue", "released");
    plot.line(erosion.chainage, volume, "series blue", "released, and entrained upstream of here");
    return chart_json({"Volume against chainage", 1000, 325, {std::move(plot)}});
}

Json bed_json(const params::BedSpec& bed) {
    const bool growth = bed.law == params::EntrainmentLaw::growth;
    return {{"name", bed.name},
            {"depth_m", bed.depth ? Json(*bed.depth) : Json()},
            {"depth_from_raster", !bed.depth && !bed.depth_raster.empty()},
            {"depth_from_polygons", !bed.depth && bed.depth_raster.empty()},
            {"growth_percent_per_m", growth ? Json(100 * bed.growth_rate.value_or(0)) : Json()},
            {"shear", growth ? Json()
                             : Json{{"erosion_rate_mps", bed.erosion_rate},
                                    {"critical_shear_stress_Pa", bed.critical_shear_stress},
                                    {"depth_per_shear_m_per_kPa", 1e3 * bed.erosion_depth_per_shear}}}};
}

}  // namespace

Json erosion(const scene::Scene& scene, const run::RunResult& result) {
    if (scene.bed.empty()) return {};
    const double volume = result.observation.erosion.volume;
    Json json = {{"volume_m3", volume},
                 {"share_of_released", volume / result.observation.volume_released},
                 {"beds", Json::array()},
                 {"chart", erosion_chart(result)}};
    for (const params::BedSpec& bed : scene.spec.beds) json["beds"].push_back(bed_json(bed));
    return json;
}

Json zones(const scene::Scene& scene) {
    const params::MaterialSpec& material = scene.spec.material;
    if (scene.spec.zones.empty() && scene.bed.empty()) return {};
    return {{"elsewhere", scene.spec.zones.empty()
                              ? Json()
                              : Json{{"friction_coefficient", material.friction_coefficient},
                                     {"turbulent_friction_mps2",
                                      material.turbulent_friction ? Json(*material.turbulent_friction) : Json()},
                                     {"laminar_viscosity_m2ps", params::laminar_viscosity_of(material)},
                                     {"cohesion_Pa", material.cohesion}}},
            {"bed", !scene.spec.beds.empty()}};
}

}  // namespace talus::report
