#pragma once

#include <string>
#include <vector>

#include "core/grid.hpp"
#include "observe/observation.hpp"
#include "params/spec.hpp"
#include "report/colour.hpp"
#include "report/hazard_map.hpp"

/// Intensity classes of published guidelines, each a table of data, from peak depth and peak speed.
namespace talus::report {

/// A way into a class: all of these are exceeded.
struct IntensityLimit {
    double depth = 0;        ///< h, m
    double speed = 0;        ///< v, m/s
    double depth_speed = 0;  ///< h v, m2/s
};

struct IntensityClass {
    std::string name;                    ///< "high"
    std::string criterion;               ///< of the limits, in symbols
    std::vector<IntensityLimit> any_of;  ///< one of them is enough
    report::Colour colour;
};

struct IntensityGuideline {
    std::string name;                     ///< "Swiss debris-flow classes"
    std::string citation;                 ///< author, year, title
    std::string remark;                   ///< what was made of it
    std::vector<IntensityClass> classes;  ///< the most severe last

    /// 1 + the most severe class that a place belongs to; 0: none.
    [[nodiscard]] int class_of(double depth, double speed) const;
    /// By the peak depth at the walls of a building and the peak depth-averaged speed in front of them. nullptr: not
    /// hit, or no class.
    [[nodiscard]] const IntensityClass* class_of(const observe::BuildingImpact& impact) const;
};

[[nodiscard]] const IntensityGuideline& intensity_guideline(params::GuidelineChoice choice);

/// Class numbers from 1 up wherever debris arrived; NaN elsewhere. Peak depth and peak speed need not have occurred at
/// one moment, so that a class may be too high, not too low.
[[nodiscard]] Grid<float> intensity_map(const IntensityGuideline& guideline, const HazardMaps& maps);

/// How it is written and drawn.
[[nodiscard]] HazardMap intensity_style(const IntensityGuideline& guideline);

}  // namespace talus::report
