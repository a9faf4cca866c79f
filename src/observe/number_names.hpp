#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/angle.hpp"
#include "core/hazard_maps.hpp"
#include "observe/observation.hpp"
#include "observe/peaks.hpp"

namespace talus::observe {

/// A scalar result of a run, by the name that files, messages and other programs know it by.
struct NamedNumber {
    std::string_view key;  ///< with its unit: "drop_m"
    const char* title;
    const char* unit;  ///< of files and messages
    int decimals;      ///< in that unit, of a debris flow; those of a flume are more (core/decimals.hpp)
    double (*value)(const Observation&);
    double TimeSample::*sample = nullptr;  ///< of a volume: the same at one moment
};

template <double TimeSample::*sample>
constexpr NamedNumber volume_at_end(std::string_view key, const char* title) {
    return {key, title, "m3", 0, [](const Observation& o) { return o.at_end().*sample; }, sample};
}

/// In the order in which they are written. Tables, manifest, reports, printed results, ensembles and the live twin use
/// these; tests/report/number_names_test.cpp names the lists of other languages that lack one.
inline constexpr std::array named_numbers = {
    // How far debris ran.
    NamedNumber{"run_out_along_flow_m", "Run-out along the flow", "m", 0,
                [](const Observation& o) { return o.run_out.along_flow; }},
    NamedNumber{"run_out_straight_m", "Run-out in a straight line", "m", 0,
                [](const Observation& o) { return o.run_out.straight; }},
    NamedNumber{"drop_m", "Drop from crown to toe", "m", 0, [](const Observation& o) { return o.run_out.drop; }},
    NamedNumber{"runout_angle_deg", "Run-out angle", "deg", 1,
                [](const Observation& o) { return o.run_out.runout_angle * degrees_per_radian; }},
    NamedNumber{"travel_angle_deg", "Travel angle of the centres of mass", "deg", 1,
                [](const Observation& o) { return o.run_out.travel_angle * degrees_per_radian; }},
    NamedNumber{"front_chainage_m", "Front to chainage", "m", 0,
                [](const Observation& o) { return o.run_out.front_chainage; }},
    NamedNumber{"deposit_area_m2", "Deposit area", "m2", 0, [](const Observation& o) { return o.deposit.area; }},
    NamedNumber{"deposit_depth_m", "Deposit depth", "m", 2, [](const Observation& o) { return o.deposit.depth; }},
    // Volumes, which the time series has too. What was released and entrained is counted for the whole run.
    NamedNumber{"volume_released_m3", "Released volume", "m3", 0,
                [](const Observation& o) { return o.volume_released; }, &TimeSample::volume_released},
    NamedNumber{"volume_entrained_m3", "Entrained from the bed", "m3", 0,
                [](const Observation& o) { return o.erosion.volume; }, &TimeSample::volume_entrained},
    volume_at_end<&TimeSample::volume_held>("volume_held_m3", "Not released yet"),
    volume_at_end<&TimeSample::volume_moving>("volume_moving_m3", "Still moving"),
    volume_at_end<&TimeSample::volume_deposited>("volume_deposited_m3", "Deposited"),
    volume_at_end<&TimeSample::volume_left>("volume_left_m3", "Left the terrain"),
};
inline constexpr std::span run_out_numbers = std::span(named_numbers).first<5>();
inline constexpr std::span deposit_numbers = std::span(named_numbers).subspan<6, 2>();
inline constexpr std::span volume_numbers = std::span(named_numbers).last<6>();
inline constexpr const NamedNumber& run_out_number = named_numbers[0];
inline constexpr const NamedNumber& front_number = named_numbers[5];
static_assert(front_number.key == "front_chainage_m" && deposit_numbers.front().key == "deposit_area_m2" &&
              volume_numbers.front().key == "volume_released_m3");

/// nullptr: none of that name.
[[nodiscard]] constexpr const NamedNumber* find_number(std::string_view key) {
    for (const NamedNumber& number : named_numbers) {
        if (number.key == key) return &number;
    }
    return nullptr;
}

/// The greatest value of a map, which has its title, unit and decimals.
struct NamedPeak {
    std::string_view key;  ///< with its unit
    const NamedMap& map;
    Peak Peaks::*peak;
    [[nodiscard]] double value(const Peaks& peaks) const { return map.factor * (peaks.*peak).value; }
};

/// In the order of the maps.
inline constexpr std::array peak_numbers = {
    NamedPeak{"peak_depth_m", *find_map("peak_depth"), &Peaks::depth},
    NamedPeak{"peak_speed_mps", *find_map("peak_speed"), &Peaks::speed},
    NamedPeak{"peak_dynamic_pressure_kPa", *find_map("peak_pressure"), &Peaks::pressure},
};

/// A unit of files and messages as reports print it.
[[nodiscard]] constexpr std::string_view printed_unit(std::string_view unit) {
    return unit == "m2" ? "m²" : unit == "m3" ? "m³" : unit == "deg" ? "°" : unit;
}

}  // namespace talus::observe
