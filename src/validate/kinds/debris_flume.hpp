#pragma once

#include <map>
#include <string>
#include <vector>

#include "validate/flume.hpp"
#include "validate/measure.hpp"
#include "validate/parameters.hpp"
#include "validate/rows.hpp"

/// What both models' runs of the flume have in common. Not for other kinds.
namespace talus::validate::debris_flume {

struct FlumeSpec {
    FlumeShape shape;
    double gate_time = 0;             // s
    double mean_time = 0;             // s
    double grid_cell = 0;             // m
    std::vector<double> spacings;     // m
    std::vector<double> stations;     // m from the gate along the bed
    std::vector<NumberPair> samples;  // station in m, time in s
    double obstacle = 0;              // m along the bed
    double ramp_angle = 0;            // rad
    double end = 0;                   // s
};

enum class Obstacle { none, wall, ramp };

inline FlumeBed bed_of(const FlumeSpec& spec, Obstacle obstacle) {
    if (obstacle != Obstacle::ramp) return FlumeBed(spec.shape);
    return FlumeBed(spec.shape, FlumeRamp{spec.obstacle, spec.ramp_angle});
}

/// What happens at the stations and the obstacle.
struct Measured {
    std::vector<double> time;                         ///< s
    std::map<double, std::vector<double>> thickness;  ///< m, over time, by station
    double run_up = not_computed;
    std::size_t particles = 0;
    std::string problem;

    [[nodiscard]] double arrival(double station) const { return first_time_of(time, thickness.at(station), arrived); }
    [[nodiscard]] double mean(double station, double at, double over) const {
        return time_mean(time, thickness.at(station), at - over / 2, at + over / 2);
    }

    static constexpr double arrived = 0.02;                 // m thick
    static constexpr double window = 0.5, interval = 0.02;  // m along the bed, s between readings
};

/// A run of either model: it knows the thickness of the debris about a place along the bed, as a mean over the window
/// and the width.
class Flow {
  public:
    virtual ~Flow() = default;
    /// Until so many seconds after the gate began to open. False: it ended before, see problem().
    virtual bool advance_to(double time) = 0;
    virtual void read(const std::vector<double>& places, std::vector<double>& thickness) = 0;
    virtual double depth_at_wall() = 0;
    [[nodiscard]] virtual std::string problem() const = 0;
};

}  // namespace talus::validate::debris_flume
