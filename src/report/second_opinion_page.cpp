// The page of both models, with its maps.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/try.hpp"
#include "report/map.hpp"
#include "report/number_text.hpp"
#include "report/results.hpp"
#include "report/second_opinion_parts.hpp"
#include "report_files.hpp"

namespace talus::report {
namespace {

constexpr Colour blue{67, 147, 195}, orange{224, 130, 20}, shared{92, 92, 100};

/// A peak map of both models and what the page says of it.
struct PeakMap {
    const HazardMap& of_run;
    const run::MapPair& maps;
    const char* what;  ///< in a sentence
    const char* deeper;
};

std::array<PeakMap, 3> peak_maps(const run::SecondOpinion& opinion) {
    const std::vector<HazardMap>& maps = hazard_maps();
    return {{{maps[0], opinion.depth, "vertical flow depth", "deeper"},
             {maps[1], opinion.speed, "depth-averaged speed", "faster"},
             {maps[2], opinion.pressure, "dynamic pressure of the free flow, ρv²,", "higher"}}};
}

/// The difference that nineteen of twenty cells stay within: the scale of the map, which one cell must not set.
double usual_difference(const Grid<float>& difference) {
    std::vector<float> sizes;
    for (const float value : difference.values) {
        if (!std::isnan(value)) sizes.push_back(std::abs(value));
    }
    if (sizes.empty()) return 0;
    const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    return *at;
}

HazardMap difference_style(const PeakMap& peak) {
    const HazardMap& of = peak.of_run;
    HazardMap style;
    style.file = fmt::format("{}_difference", of.file);
    style.title = fmt::format("Difference in {}", peak.what);
    style.unit = of.unit;
    style.factor = of.factor;
    Classes classes = difference_classes(of.factor * usual_difference(peak.maps.difference));
    style.breaks = std::move(classes.breaks);
    style.colours = std::move(classes.colours);
    return style;
}

std::string largest_text(const BothModels& models, const PeakMap& peak) {
    const run::LargestDifference& largest = peak.maps.largest;
    if (!largest.known() || largest.size() == 0) return "";
    const auto shown = [&](const Grid<float>& map, double value) {
        if (std::isnan(value_at(map, largest.at))) return std::string("no debris");
        return fmt::format("{}\u00a0{}", fixed(peak.of_run.factor * value, peak.of_run.digits), peak.of_run.unit);
    };
    return fmt::format(" Largest {}: {} with particles, {} depth-averaged.", place(models.scene, largest.at),
                       shown(peak.maps.particles, largest.particles),
                       shown(peak.maps.depth_averaged, largest.depth_averaged));
}

Grid<float> classes_of_area(const run::SecondOpinion& opinion, double least) {
    Grid<float> classes = opinion.depth.difference;
    for (std::size_t i = 0; i < classes.values.size(); ++i) {
        const int by = (opinion.depth.depth_averaged.values[i] > least ? 1 : 0) +
                       (opinion.depth.particles.values[i] > least ? 2 : 0);
        classes.values[i] = by == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(by);
    }
    return classes;
}

/// Three maps: of each model, in the same colours, and their difference.
void add_layers(const BothModels& models, const PeakMap& peak, MapContent& content) {
    HazardMap style = peak.of_run;
    const std::string& name = style.title;
    style.full_scale = style.factor * std::fmax(peak.maps.peak_particles.value, peak.maps.peak_depth_averaged.value);
    for (const auto& [result, model, words] :
         {std::tuple{&models.particles, "particles", "with particles"},
          std::tuple{&models.depth_averaged, "depth-averaged", "in the depth-averaged model"}}) {
        style.file = fmt::format("{}_{}", peak.of_run.file, result->depth_averaged() ? "depth_averaged" : "particles");
        content.layers.push_back({style, &(result->observation.maps.*style.grid), fmt::format("{}, {}", name, model),
                                  fmt::format("Greatest {} at each place, {}.", peak.what, words), style.digits, "",
                                  name});
    }
    const HazardMap difference = difference_style(peak);
    content.layers.push_back(
        {difference, &peak.maps.difference, fmt::format("{}, difference", name),
         fmt::format("Depth-averaged less particles, as means over the same cells; blue where the depth-averaged model "
                     "is {}, orange where the particles are.{}",
                     peak.deeper, largest_text(models, peak)),
         style.digits, "", name});
}

}  // namespace

Result<std::string> second_opinion_report(const BothModels& models, const run::SecondOpinion& opinion,
                                          const Json& results) {
    const Grid<float> areas = classes_of_area(opinion, models.scene.spec.outputs.arrival_depth);
    MapContent content = map_content(models.scene, models.particles);
    content.reached = &opinion.depth.difference;
    content.farthest_chainage =
        std::fmax(content.farthest_chainage, models.depth_averaged.observation.run_out.front_chainage);
    content.cell = opinion.depth.difference.geometry.cell;
    if (!results["status"]["beyond_limits"].is_null()) content.beyond_limits = results["status"]["beyond_limits"];
    content.buildings.title = "Structures hit in";
    for (std::size_t k = 0; k < hit_by_names.size(); ++k) content.buildings.class_names.at(k) = hit_by_names.at(k);
    content.buildings.classes.clear();
    content.buildings.titles.clear();
    for_each_structure(models, [&](const auto& impact, const auto&, HitBy by) {
        content.buildings.classes.push_back(by);
        content.buildings.titles.push_back(
            fmt::format("{}: {}", name_of(impact), by == neither ? "not hit" : hit_by_names.at(by)));
    });
    content.layers.clear();
    for (const PeakMap& peak : peak_maps(opinion)) add_layers(models, peak, content);
    HazardMap area;
    area.file = "affected_area";
    area.title = "Affected area";
    area.categories = {{"depth-averaged only", blue}, {"particles only", orange}, {"both", shared}};
    content.layers.push_back({area, &areas, "Affected area", "Where debris stood deeper than the arrival depth.", 0,
                              "deeper than the arrival depth"});
    TALUS_ASSIGN(auto maps, map_figures(models.scene, content));
    Json page = results;
    page["report_name"] = "two models compared";
    page["masthead"] = "Landslide run-out, two models compared";
    page["maps"] = std::move(maps);
    page["flight"] = models.grid_scene.spec.solver.flight;
    page["verdicts"] = Json::array({named_verdict("Particles", results["verdict"]["particles"]),
                                    named_verdict("Depth-averaged", results["verdict"]["depth_averaged"])});
    return render(report_files::second_opinion_html, page);
}

}  // namespace talus::report
