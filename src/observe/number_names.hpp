#pragma once

#include <array>
#include <string_view>

#include "core/angle.hpp"
#include "observe/observation.hpp"

namespace talus::observe {

/// A scalar result of a run, by the name that files, messages and other programs know it by.
struct NamedNumber {
    std::string_view key;  ///< with its unit: "drop_m"
    const char* title;
    const char* unit;  ///< of files and messages
    int decimals;      ///< in that unit, of a debris flow; those of a flume are more (core/decimals.hpp)
    double (*value)(const Observation&);
};

inline constexpr NamedNumber front_number{"front_chainage_m", "Front to chainage", "m", 0,
                                          [](const Observation& o) { return o.run_out.front_chainage; }};

/// How far debris ran, in the order in which the numbers are written. Tables, manifest, printed results, ensembles and
/// the live twin use these; tests/report/number_names_test.cpp names the lists of other languages that lack one.
inline constexpr std::array run_out_numbers = {
    NamedNumber{"run_out_along_flow_m", "Run-out along the flow", "m", 0,
                [](const Observation& o) { return o.run_out.along_flow; }},
    NamedNumber{"run_out_straight_m", "Run-out in a straight line", "m", 0,
                [](const Observation& o) { return o.run_out.straight; }},
    NamedNumber{"drop_m", "Drop from crown to toe", "m", 0, [](const Observation& o) { return o.run_out.drop; }},
    NamedNumber{"runout_angle_deg", "Run-out angle", "deg", 1,
                [](const Observation& o) { return o.run_out.runout_angle * degrees_per_radian; }},
    NamedNumber{"travel_angle_deg", "Travel angle of the centres of mass", "deg", 1,
                [](const Observation& o) { return o.run_out.travel_angle * degrees_per_radian; }},
};
inline constexpr const NamedNumber& run_out_number = run_out_numbers.front();

}  // namespace talus::observe
