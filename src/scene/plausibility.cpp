#include "scene/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/angle.hpp"
#include "geo/terrain_frame.hpp"
#include "scene/particle_spacing.hpp"

namespace talus::scene {
namespace {

constexpr std::size_t max_samples = 250'000;

// Soil-covered hillsides stand at 25 to 40 degrees, and only cliffs at more than 55.
constexpr double steepest_median = 42, steepest_tenth = 58, steepest_release = 50, steep_release = 45;  // degrees
/// Deviation of a cell from the mean of its neighbours, in cells: 0.3 is a kink of 33 degrees at every tenth cell.
constexpr double roughest_tenth = 0.3;

struct Relief {
    std::vector<double> slopes;     ///< rise over run
    std::vector<double> roughness;  ///< in cells
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
};

Relief relief_of(const Grid<float>& elevation, const ReachableGround& reachable) {
    Relief relief;
    const GridGeometry& g = elevation.geometry;
    const double cells = reachable.cells().value_or(static_cast<double>(g.size()));
    const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(cells / max_samples))));
    for (int r = 1; r + 1 < g.rows; r += stride) {
        for (int c = 1; c + 1 < g.columns; c += stride) {
            if (!reachable.holds(c, r)) continue;
            const double here = elevation.at(c, r);
            const double west = elevation.at(c - 1, r), east = elevation.at(c + 1, r);
            const double south = elevation.at(c, r - 1), north = elevation.at(c, r + 1);
            const double around = (west + east + south + north) / 4;
            if (std::isnan(around + here)) continue;
            relief.slopes.push_back(std::hypot(east - west, north - south) / (2 * g.cell));
            relief.roughness.push_back(std::abs(here - around) / g.cell);
            relief.lowest = std::min(relief.lowest, here);
            relief.highest = std::max(relief.highest, here);
        }
    }
    return relief;
}

/// The value that a share of them exceeds; 0 of none.
double exceeded_by(double share, std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((1 - share) * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double angle(double rise_over_run) {
    return std::atan(rise_over_run) * degrees_per_radian;
}

/// Mean over its area, degrees.
double mean_slope(const Scene& scene, const terrain::Release& release) {
    double plan = 0;
    for (const terrain::ReleasePatch& patch : release.patches) plan += plan_area(patch.polygon);
    const double on_slope = release_slope_area(scene.terrain, release);
    return on_slope > 0 ? std::acos(std::min(1.0, plan / on_slope)) * degrees_per_radian : 0;
}

std::string count_text(double particles) {
    const std::string number = fmt::format("{:.2g}", particles);
    return number + (number == "1" ? " particle" : " particles");
}

}  // namespace

void note_implausible_terrain(const ReachableGround& reachable, Scene& scene) {
    constexpr double foot = 0.3048;
    Relief relief = relief_of(scene.terrain.elevation(), reachable);
    if (relief.slopes.empty()) return;
    // Debris is released from slopes of 20 degrees and more: in feet, of 50 and more.
    const auto steep = [&](const terrain::Release& release) { return mean_slope(scene, release) > steep_release; };
    const bool may_be_feet = scene.releases.empty() || std::any_of(scene.releases.begin(), scene.releases.end(), steep);
    const double median = exceeded_by(0.5, relief.slopes), tenth = exceeded_by(0.1, relief.slopes);
    const double rough = exceeded_by(0.1, relief.roughness);
    const Extent extent = scene.terrain.elevation().geometry.extent();
    const double across = std::max(extent.width(), extent.height()), height = relief.highest - relief.lowest;

    std::vector<std::string> found;
    if (may_be_feet && (angle(median) > steepest_median || angle(tenth) > steepest_tenth)) {
        found.push_back(fmt::format("half of it is steeper than {:.0f} degrees and a tenth steeper than {:.0f}",
                                    angle(median), angle(tenth)));
    }
    if (may_be_feet && height > across)
        found.push_back(fmt::format("it is {:.0f} m high on a length of {:.0f} m", height, across));
    if (relief.highest > 9000 || relief.lowest < -1000) {
        found.push_back(fmt::format("elevations go from {:.0f} to {:.0f} m", relief.lowest, relief.highest));
    }
    if (rough > roughest_tenth) {
        found.push_back(
            fmt::format("a tenth of its cells lie over {:.2g} cells above or below their neighbours", rough));
    }
    for (const terrain::Release& release : scene.releases) {
        const double slope = mean_slope(scene, release);
        if (slope <= steepest_release) continue;
        found.push_back(
            fmt::format("release \"{}\" lies at {:.0f} degrees, where soil hardly stays", release.name, slope));
    }
    if (found.empty()) return;
    const params::TerrainSpec& spec = scene.spec.terrain;
    const std::string feet =
        may_be_feet ? fmt::format(
                          " If its elevations are in feet while its plan is in metres, half of it is steeper than "
                          "{:.0f} degrees in truth: {}.",
                          angle(foot * median), geo::scale_command(spec.file, spec.band, foot))
                    : "";
    scene.notes.push_back(
        fmt::format("terrain: where debris can go, {}; check these heights.{} A surface model with trees and "
                    "houses looks so{}: use one of the ground",
                    fmt::join(found, "; "), feet, may_be_feet ? " too" : ""));
}

void note_coarse_particles(Scene& scene) {
    if (scene.releases.empty()) return;
    constexpr double layers = 5;
    const double spacing = particle_spacing(scene);
    for (const terrain::Release& release : scene.releases) {
        const double thickness = mean_thickness(scene.terrain, release);
        if (!(thickness > 0) || spacing <= thickness / layers) continue;
        const double wanted = thickness / layers;
        const std::string needed =
            fmt::format("{:.0f} layers need solver.particle_spacing_m = {:.2g}, about {:.2g} particles", layers, wanted,
                        total_volume(scene) / (wanted * wanted * wanted));
        scene.notes.push_back(
            spacing > thickness
                ? fmt::format(
                      "release \"{}\": particles are {:.3g} m apart, more than it is thick ({:.3g} m): they move "
                      "as single grains, whose compression looks perfect and whose depths, speeds and forces "
                      "mean little; {}",
                      release.name, spacing, thickness, needed)
                : fmt::format("release \"{}\": it is {} thick ({:.3g} m); {}", release.name,
                              count_text(thickness / spacing), thickness, needed));
    }
}

}  // namespace talus::scene
