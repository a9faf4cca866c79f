#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry.hpp"

/// The shape of a flume and of the debris behind its gate.
namespace talus::validate {

struct FlumeShape {
    double slope = 0, pad_slope = 0;      ///< rad
    double bend_start = 0, bend_end = 0;  ///< m from the gate along the bed
    double width = 0, volume = 0;         ///< m, m3
    double gate_height = 0;               ///< m, of the debris at the gate, vertical
    double top_length = 0;                ///< m along its surface behind that
    double top_slope = 0;                 ///< rad
};

/// A ramp that rises from a place along the bed on.
struct FlumeRamp {
    double foot = 0, angle = 0;  ///< m, rad
};

/// The bed by the distance s along it from the gate: steep, bent as a circle, nearly level.
class FlumeBed {
  public:
    explicit FlumeBed(const FlumeShape& shape, const std::optional<FlumeRamp>& ramp = {});

    [[nodiscard]] double length() const { return points_.back().x - points_.front().x; }
    /// Plan x in a world around the middle, and elevation, of a place along the bed.
    [[nodiscard]] PlanPoint at(double s) const;
    /// The place along the bed below a plan x.
    [[nodiscard]] double along(double x) const;
    /// Its upper end, m.
    static constexpr double first = -12;

  private:
    static constexpr double step = 0.02;        // m
    static constexpr std::size_t count = 6300;  // to s = 114 m

    [[nodiscard]] static double place(std::size_t k) { return first + step * static_cast<double>(k); }

    double middle_ = 0;
    std::vector<PlanPoint> points_;
};

/// The debris behind the closed gate, as George & Iverson (2014, figure 11) draw it: a vertical gate, a straight
/// surface behind it that rises less than the bed, and a straight back down to the bed, as far away as the volume
/// requires.
class FlumeFill {
  public:
    FlumeFill(const FlumeShape& shape, const FlumeBed& bed);

    /// Whether the volume is enough for gate and surface, and lies on the bed.
    [[nodiscard]] bool holds_volume() const { return back_ > FlumeBed::first && back_ <= edge_; }
    [[nodiscard]] double back() const { return back_; }      ///< where it ends on the bed, m along that
    [[nodiscard]] double height() const { return height_; }  ///< greatest, normal to the bed, m
    /// Elevation of the surface over a plan x; that of the bed where there is no debris.
    [[nodiscard]] double top(double x) const;

  private:
    const FlumeBed& bed_;
    double back_ = 0, edge_ = 0, height_ = 0;
    std::vector<PlanPoint> surface_;  ///< from the back to the gate
};

}  // namespace talus::validate
