#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "observe/observation.hpp"
#include "report/colour.hpp"

namespace talus::report {

/// A class of a map that has no measure.
struct Category {
    std::string name;
    report::Colour colour;
};

/// A map among the products: where it comes from, what it is called, how it is coloured.
struct HazardMap {
    std::string file;                         ///< without extension: "peak_depth"
    std::string title;                        ///< "Peak depth"
    std::string description;                  ///< of the band
    std::string unit;                         ///< of the band and of `breaks`
    double factor = 1;                        ///< from SI to `unit`
    Grid<float> HazardMaps::*grid = nullptr;  ///< nullptr: not one of a single run's maps
    std::vector<double> breaks;  ///< lower limits of the classes; below the first: not drawn. Empty: even classes
    Ramp ramp;
    double full_scale = 0;          ///< classes reach at least up to here, so that maps of a kind have the same colours
    std::vector<Colour> colours{};  ///< of the classes of `breaks`, all of them, in place of the ramp
    std::vector<Category> categories{};  ///< of the values 1, 2, ...; then breaks and ramp are not used

    // On the map of a report.
    std::string tab{};      ///< "Deposit"
    std::string caption{};  ///< a sentence
    int digits = 2;         ///< of values
};

/// All maps, in the order in which they are written.
[[nodiscard]] const std::vector<HazardMap>& hazard_maps();

/// Depth of erosion: not among the maps of every run, and on the terrain's cells.
[[nodiscard]] const HazardMap& erosion_map();

/// Peak depth normal to the slope: only if outputs.peak_thickness is set.
[[nodiscard]] const HazardMap& thickness_map();

/// The map in its own unit.
[[nodiscard]] Grid<float> in_unit(const Grid<float>& si, double factor);

/// Greatest value of a grid; 0 where it has none.
[[nodiscard]] double greatest(const Grid<float>& grid);

/// A QGIS 3 layer style: classes with labels in the map's unit, transparent below the first one and at nodata.
[[nodiscard]] std::string qgis_style(const HazardMap& map, double largest, std::size_t band = 1);

/// A QGIS 3 layer style of elevations: their hillshade.
[[nodiscard]] std::string qgis_hillshade_style();

}  // namespace talus::report
