#include "report/intensity.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace talus::report {
namespace {

// Apart from the yellow to red of buildings that were hit, and ever darker.
constexpr report::Colour low_colour{214, 196, 232}, medium_colour{153, 101, 196}, high_colour{72, 20, 112};

constexpr const char* swiss =
    "BWW, BRP & BUWAL (1997), Berücksichtigung der Hochwassergefahren bei raumwirksamen Tätigkeiten, Empfehlungen "
    "(Loat & Petrascheck), Biel";

/// In the order of GuidelineChoice.
const std::array<IntensityGuideline, 3>& guidelines() {
    static const std::array<IntensityGuideline, 3> all = {{
        {"Swiss debris-flow classes",
         swiss,
         "Limits as the documentation of FLO-2D MapCrafter gives them after Vademecum: Hazard maps and related "
         "instruments (2005); the recommendation was not at hand. It has no low class for debris flows: all that "
         "debris "
         "reached is at least medium.",
         {{"medium", "h ≤ 1 m or v ≤ 1 m/s", {{}}, medium_colour},
          {"high", "h > 1 m and v > 1 m/s", {{.depth = 1, .speed = 1}}, high_colour}}},
        {"Swiss flood classes",
         swiss,
         "For floods that carry sediment; debris flows have classes of their own. Limits from the same source as "
         "theirs.",
         {{"low", "h ≤ 0.5 m and h v ≤ 0.5 m²/s", {{}}, low_colour},
          {"medium", "h > 0.5 m or h v > 0.5 m²/s", {{.depth = 0.5}, {.depth_speed = 0.5}}, medium_colour},
          {"high", "h > 2 m or h v > 2 m²/s", {{.depth = 2}, {.depth_speed = 2}}, high_colour}}},
        {"Venezuelan debris-flow classes",
         "García, López, Noya, Bello, Bello, González, Paredes, Vivas & O'Brien (2003), Hazard mapping for debris flow "
         "events in the alluvial fans of northern Venezuela, Debris-Flow Hazards Mitigation, Davos",
         "Cited from memory. Debris no deeper than 0.2 m has no class.",
         {{"low", "h > 0.2 m", {{.depth = 0.2}}, low_colour},
          {"medium", "h > 0.2 m and h v > 0.2 m²/s", {{.depth = 0.2, .depth_speed = 0.2}}, medium_colour},
          {"high", "h > 1 m or h v > 1 m²/s", {{.depth = 1}, {.depth_speed = 1}}, high_colour}}},
    }};
    return all;
}

}  // namespace

int IntensityGuideline::class_of(double depth, double speed) const {
    for (std::size_t k = classes.size(); k > 0; --k) {
        for (const IntensityLimit& limit : classes[k - 1].any_of) {
            if (depth > limit.depth && speed >= 0 && (limit.speed == 0 || speed > limit.speed) &&
                (limit.depth_speed == 0 || depth * speed > limit.depth_speed)) {
                return static_cast<int>(k);
            }
        }
    }
    return 0;
}

const IntensityClass* IntensityGuideline::class_of(const observe::BuildingImpact& impact) const {
    const double speed = std::isnan(impact.peak_speed) ? 0 : impact.peak_speed;  // of debris too thin to have one
    const int found = impact.hit ? class_of(impact.peak_depth, speed) : 0;
    return found > 0 ? &classes[static_cast<std::size_t>(found) - 1] : nullptr;
}

const IntensityGuideline& intensity_guideline(params::GuidelineChoice choice) {
    return guidelines().at(static_cast<std::size_t>(choice));
}

Grid<float> intensity_map(const IntensityGuideline& guideline, const HazardMaps& maps) {
    Grid<float> classes(maps.peak_depth.geometry, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < classes.values.size(); ++i) {
        if (std::isnan(maps.arrival_time.values[i])) continue;
        const int found = guideline.class_of(maps.peak_depth.values[i], maps.peak_speed.values[i]);
        if (found > 0) classes.values[i] = static_cast<float>(found);
    }
    return classes;
}

HazardMap intensity_style(const IntensityGuideline& guideline) {
    HazardMap style;
    style.file = "intensity";
    style.title = "Intensity";
    style.description = "intensity, " + guideline.name + ":";
    for (std::size_t k = 0; k < guideline.classes.size(); ++k) {
        const IntensityClass& c = guideline.classes[k];
        style.description += fmt::format("{} {} {}", k == 0 ? "" : ",", k + 1, c.name);
        style.categories.push_back({c.name, c.colour});
    }
    return style;
}

}  // namespace talus::report
