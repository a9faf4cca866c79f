#pragma once

#include <functional>
#include <string>

#include "depth/solver.hpp"
#include "params/spec.hpp"
#include "validate/case.hpp"

/// The depth-averaged model on the grounds of the cases.
namespace talus::validate {

/// "depth-averaged, 200 cells".
[[nodiscard]] std::string grid_name(int cells);

/// Debris on a plane that falls towards +x, in coordinates along the slope and across it, m. Cells are square in plan.
class GridIncline {
  public:
    struct Plane {
        double slope = 0;             ///< rad
        double from = 0, length = 0;  ///< along the slope
        double width = 0;             ///< across, about 0; 0: a strip that is the same across
        double cell = 0;              ///< along the slope
    };
    /// The friction coefficient replaces the material's. `thickness`: normal to the slope, at rest.
    GridIncline(const Plane& plane, const params::MaterialSpec& material, double friction_coefficient,
                const std::function<double(double along, double across)>& thickness);

    /// Gives all debris this velocity down the slope; call it before the first step.
    void set_velocity(double velocity);
    /// Steps until then. Returns the problem; empty: none.
    [[nodiscard]] std::string advance_to(double time, const Watch& watch);

    /// For what else happens to the debris. Its rows begin at y = 0; x of a place along the slope is x_at().
    [[nodiscard]] depth::Solver& solver() { return solver_; }
    [[nodiscard]] double x_at(double along) const { return (along - from_) * cosine_; }
    [[nodiscard]] int columns() const { return solver_.geometry().columns; }
    [[nodiscard]] int rows() const { return solver_.geometry().rows; }
    [[nodiscard]] double along(int column) const;
    [[nodiscard]] double across(int row) const;
    [[nodiscard]] double thickness(int column, int row) const;
    [[nodiscard]] double velocity(int column, int row) const;  ///< down the slope, m/s

  private:
    double cosine_, from_, width_;
    depth::Solver solver_;
};

}  // namespace talus::validate
