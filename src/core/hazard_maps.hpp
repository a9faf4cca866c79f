#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "core/grid.hpp"
#include "core/ramp.hpp"

/// The maps of a run: their one table, which scenes, products, reports, the records of ensembles, the live twin with
/// its messages and page, and the interface for other programs follow.
namespace talus {

/// Rasters over the part of the terrain that debris reached, grown by a margin. NaN: debris never came there.
struct HazardMaps {
    Grid<float> peak_depth;       ///< vertical flow depth, m
    Grid<float> peak_speed;       ///< depth-averaged speed, m/s
    Grid<float> peak_pressure;    ///< dynamic: density * speed^2, Pa
    Grid<float> arrival_time;     ///< first time above the arrival depth, s
    Grid<float> deposit_depth;    ///< depth at the end of the run, m
    Grid<float> arrival_speed{};  ///< depth-averaged speed at the arrival time, m/s
};

/// What a map keeps of the flow in a cell.
enum class MapKind : std::uint8_t {
    peak,     ///< the greatest value so far
    arrival,  ///< when debris first came: without debris there is no value, on the other maps nothing is 0
    present,  ///< the depth as it is: its sum over cells is a volume
};

/// The flow in a cell at one moment, averaged over its depth.
struct CellFlow {
    double depth = 0, speed = 0, density = 0;  ///< m, m/s, kg/m3
};

/// A map of a run, by the name that files, messages and other programs know it by.
struct NamedMap {
    std::string_view key;
    Grid<float> HazardMaps::*grid = nullptr;
    MapKind kind = MapKind::peak;
    double (*value)(const CellFlow& flow) = nullptr;  ///< of one moment, SI; nullptr: an arrival
    const char* title = "";
    const char* unit = "";  ///< of files and reports
    double factor = 1;      ///< from SI to `unit`
    int decimals = 1;       ///< in that unit, of a single value

    const char* description = "";  ///< of the band
    const char* caption = "";      ///< a sentence, in a report
    const char* tab = nullptr;     ///< the short title there; nullptr: the title
    int digits = 1;                ///< there
    /// Lower limits of classes, in `unit`; below the first nothing is drawn. Empty: even classes.
    std::span<const double> breaks{};
    Ramp ramp{};

    const char* title_so_far = nullptr;  ///< of the file of a live run; nullptr: the title
    const char* help = "";               ///< of the layer of a live run
    double least = 0;                    ///< in `unit`; the page does not draw what is below
};

namespace map_breaks {

/// 0.5 and 1 m are the limits of common intensity classes.
inline constexpr std::array depth = {0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0};
inline constexpr std::array speed = {0.0, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0};
/// 15 and 30 kPa separate slight, extensive and complete damage to buildings not of reinforced concrete (Kang & Kim
/// 2014).
inline constexpr std::array pressure = {0.0, 5.0, 15.0, 30.0, 50.0, 100.0, 200.0, 400.0, 800.0};
inline constexpr std::array deposit = {0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0};

}  // namespace map_breaks

/// The maps that every run has, in the order in which they are written; new ones at the end, as ensembles know the
/// first by their place. What a step adds to one is in observe/map_shares.hpp and observe/grid_observer.cpp;
/// tests/report/hazard_maps_test.cpp names the lists of other languages that lack it.
inline constexpr std::array named_maps = {
    NamedMap{.key = "peak_depth",
             .grid = &HazardMaps::peak_depth,
             .kind = MapKind::peak,
             .value = [](const CellFlow& flow) { return flow.depth; },
             .title = "Peak depth",
             .unit = "m",
             .description = "peak flow depth, vertical",
             .caption = "Greatest vertical flow depth at each place during the run.",
             .digits = 2,
             .breaks = map_breaks::depth,
             .ramp = {205, 0.05, 268, 0.15, 0.90, 0.28},
             .help = "Largest flow depth so far, vertical",
             .least = 0.01},
    NamedMap{.key = "peak_speed",
             .grid = &HazardMaps::peak_speed,
             .kind = MapKind::peak,
             .value = [](const CellFlow& flow) { return flow.speed; },
             .title = "Peak speed",
             .unit = "m/s",
             .description = "peak depth-averaged speed",
             .caption = "Greatest depth-averaged speed at each place during the run.",
             .breaks = map_breaks::speed,
             .ramp = {104, 0.11, 8, 0.13, 0.93, 0.28},
             .help = "Largest depth-averaged speed so far",
             .least = 0.05},
    NamedMap{.key = "peak_pressure",
             .grid = &HazardMaps::peak_pressure,
             .kind = MapKind::peak,
             .value = [](const CellFlow& flow) { return flow.density * flow.speed * flow.speed; },
             .title = "Peak dynamic pressure",
             .unit = "kPa",
             .factor = 1e-3,
             .decimals = 0,
             .description = "peak dynamic pressure of the free flow, density x speed^2",
             .caption = "Greatest dynamic pressure of the free flow at each place: density times the square of the "
                        "depth-averaged speed.",
             .digits = 0,
             .breaks = map_breaks::pressure,
             .ramp = {88, 0.08, -48, 0.14, 0.93, 0.26},
             .help = "Largest dynamic pressure of the free flow so far: density times speed squared",
             .least = 0.01},
    NamedMap{.key = "arrival_time",
             .grid = &HazardMaps::arrival_time,
             .kind = MapKind::arrival,
             .title = "Arrival time",
             .unit = "s",
             .description = "time of first arrival since the start of the run",
             .caption = "Time from the start of the run until debris first stands at each place.",
             .ramp = {215, 0.06, 118, 0.10, 0.30, 0.92},
             .title_so_far = "First arrival",
             .help = "Time when debris first arrived"},
    NamedMap{.key = "deposit_depth",
             .grid = &HazardMaps::deposit_depth,
             .kind = MapKind::present,
             .value = [](const CellFlow& flow) { return flow.depth; },
             .title = "Deposit depth",
             .unit = "m",
             .description = "deposit depth at the end of the run, vertical",
             .caption = "Vertical depth of debris at the end of the run. Below 0.05 m nothing is drawn.",
             .tab = "Deposit",
             .digits = 2,
             .breaks = map_breaks::deposit,
             .ramp = {92, 0.07, 42, 0.09, 0.92, 0.28},
             .title_so_far = "Depth of the debris now",
             .help = "Depth of debris as it lies",
             .least = 0.02},
};

/// Of these cells, with no value anywhere.
[[nodiscard]] inline HazardMaps empty_maps(const GridGeometry& cells) {
    HazardMaps maps;
    maps.arrival_speed = Grid<float>(cells, std::numeric_limits<float>::quiet_NaN());
    for (const NamedMap& map : named_maps) maps.*map.grid = maps.arrival_speed;
    return maps;
}

/// nullptr: none of that name.
[[nodiscard]] constexpr const NamedMap* find_map(std::string_view key) {
    for (const NamedMap& map : named_maps) {
        if (map.key == key) return &map;
    }
    return nullptr;
}

/// Names of layers: `before`, those of the maps, `after`.
[[nodiscard]] inline std::vector<std::string_view> map_keys(std::string_view before, std::string_view after = {}) {
    std::vector<std::string_view> keys{before};
    for (const NamedMap& map : named_maps) keys.push_back(map.key);
    if (!after.empty()) keys.push_back(after);
    return keys;
}

}  // namespace talus
