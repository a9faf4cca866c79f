#include <fmt/format.h>

#include "products/report_sections.hpp"
#include "products/report_text.hpp"

namespace talus::report {
namespace {

std::string law_text(const BedSpec& bed) {
    if (bed.law == EntrainmentLaw::growth) {
        return fmt::format("debris grows by {} % of its volume per metre that it moves (McDougall &amp; Hungr 2005)",
                           plain(100 * *bed.growth_rate));
    }
    return fmt::format(
        "the bed sinks at {} m/s where the shear stress on it is above {} Pa, at most by {} m per kPa above that "
        "(Frank "
        "et al. 2015)",
        plain(bed.erosion_rate), plain(bed.critical_shear_stress), plain(1e3 * bed.erosion_depth_per_shear));
}

std::string depth_text(const BedSpec& bed) {
    if (bed.depth) return fmt::format("{} m deep", plain(*bed.depth));
    return bed.depth_raster.empty() ? "as deep as its polygons say" : "as deep as its raster says";
}

}  // namespace

std::string erosion_section(const Scene& scene, const RunResult& result, int figure) {
    if (scene.bed.empty()) return "";
    const Erosion& erosion = result.observation.erosion;
    std::string html = "<section id=\"erosion\">\n<h2>Picked up from the bed</h2>\n";
    html += fmt::format("<p>Debris picked up {} m³, {} times what was released.", fixed(erosion.volume, 1),
                        fixed(erosion.volume / result.observation.volume_released, 2));
    for (const BedSpec& bed : scene.spec.beds) {
        html += fmt::format(" <b>{}</b>, {}: {}.", escape(bed.name), depth_text(bed), law_text(bed));
    }
    html +=
        " What is picked up was at rest and has the density of the debris; the ground sinks by its volume, and debris "
        "keeps its momentum. A cell of the terrain is eroded by whole particles.</p>\n";
    html += fmt::format(
        "<figure>{}\n<figcaption><b>Figure {}. Volume against chainage.</b> What was released, and on top of it what "
        "was picked up from the bed upstream of each place within the corridor of the flow path, at the end of the "
        "run. erosion.csv and erosion_depth.tif hold the numbers.</figcaption></figure>\n</section>\n",
        erosion_figure(result), figure);
    return html;
}

}  // namespace talus::report
