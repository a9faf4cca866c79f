#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry.hpp"

/// What was observed in the field, as spec.hpp has the rest of a scene file.
namespace talus::params {

/// `[[observation]]`: a velocity measured in the field.
struct ObservationSpec {
    std::string name;
    double chainage = 0;                                 ///< m along the flow path
    std::optional<double> front_velocity, debris_speed;  ///< m/s; one of them
    std::string source;
    std::optional<double> uncertainty = {};  ///< m/s, one standard deviation; absent: a fifth of the value

    /// m/s
    [[nodiscard]] double value() const { return debris_speed ? *debris_speed : front_velocity.value_or(0); }
    /// m/s
    [[nodiscard]] double standard_deviation() const { return uncertainty.value_or(value() / 5); }
    /// "Front velocity" or "Debris speed".
    [[nodiscard]] const char* quantity() const { return debris_speed ? "Debris speed" : "Front velocity"; }
    /// The same as part of a key.
    [[nodiscard]] const char* key() const { return debris_speed ? "debris_speed" : "front_velocity"; }
};

/// `[[superelevation]]`: marks on both sides of a bend, from which the velocity follows.
struct SuperelevationSpec {
    std::string name;
    double chainage = 0;                     ///< m
    double bend_radius = 0;                  ///< m, of the path's centre line in plan
    double width = 0;                        ///< m, of the flow between the marks in plan
    double level_difference = 0;             ///< m, between the marks
    double correction_factor = 1;            ///< k in v^2 = g R dh / (k b)
    std::optional<double> uncertainty = {};  ///< m/s; absent: a quarter of the velocity
    std::string source;
};

/// `[[arrival]]`: when debris first came to a chainage.
struct ArrivalSpec {
    std::string name;
    double chainage = 0;                     ///< m
    double time = 0;                         ///< s since the release
    std::optional<double> uncertainty = {};  ///< s; absent: a fifth of the time
    std::string source;
};

/// `[[run_up]]`: height that debris reached at a place, by its marks.
struct RunUpSpec {
    std::string name;
    double x = 0, y = 0;     ///< m, in the terrain's reference system
    double height = 0;       ///< m, of the mark above the ground at that place
    double uncertainty = 1;  ///< m
    std::string source;
};

/// `[[deposit_depth]]`: depth of the deposit at a place.
struct DepositDepthSpec {
    std::string name;
    double x = 0, y = 0;       ///< m
    double depth = 0;          ///< m, vertical; 0: nothing
    double uncertainty = 0.5;  ///< m
    std::string source;
};

/// `[[damage]]`: a building that was damaged or was not.
struct DamageSpec {
    std::string building;  ///< its name
    bool damaged = true;
    double pressure = 15e3;     ///< Pa, from which such a building is damaged
    double uncertainty = 10e3;  ///< Pa, of that limit
    std::string source;
};

/// `[[observed_run_out]]`: the farthest chainage of the front.
struct ObservedRunOutSpec {
    std::string name;
    double chainage = 0;      ///< m
    double uncertainty = 10;  ///< m
    std::string source;
};

/// `[[deposit_outline]]`, the edge of the deposit, and `[[affected_area]]`, the edge of all that debris covered.
struct OutlineSpec {
    std::string name, file, layer;
    double depth = 0.1;        ///< m, debris thinner than this was not mapped
    double uncertainty = 0.1;  ///< of the overlap, 0 to 1
    std::string source;
};

/// `[[elevation_change]]`: a DEM of difference, after minus before.
struct ElevationChangeSpec {
    std::string name, file;
    double detection_limit = 0.2;  ///< m, smaller changes are noise
    double uncertainty = 0.2;      ///< of the agreement, 0 to 1
    std::string source;
};

}  // namespace talus::params
