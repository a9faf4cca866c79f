#include "validate/grid_flow.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "depth/material.hpp"

namespace talus::validate {
namespace {

Grid<double> bed_of(const GridIncline::Plane& plane) {
    const double cell = plane.cell * std::cos(plane.slope);
    const int columns = std::max(1, static_cast<int>(std::lround(plane.length / plane.cell)));
    const int rows = plane.width > 0 ? std::max(1, static_cast<int>(std::lround(plane.width / cell))) : 1;
    Grid<double> bed({0, 0, cell, columns, rows});
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            bed.at(column, row) = -bed.geometry.centre(column, row).x * std::tan(plane.slope);
        }
    }
    return bed;
}

depth::Material material_with(const params::MaterialSpec& material, double friction_coefficient) {
    depth::Material result = depth::material_of(material);
    result.friction_coefficient = friction_coefficient;
    return result;
}

}  // namespace

std::string grid_name(int cells) {
    return fmt::format("depth-averaged, {} cells", cells);
}

GridIncline::GridIncline(const Plane& plane, const params::MaterialSpec& material, double friction_coefficient,
                         const std::function<double(double, double)>& thickness)
    : cosine_(std::cos(plane.slope)),
      from_(plane.from),
      width_(plane.width),
      solver_(bed_of(plane), material_with(material, friction_coefficient), {},
              plane.width > 0 ? depth::Edges::open : depth::Edges::continued) {
    for (int row = 0; row < rows(); ++row) {
        for (int column = 0; column < columns(); ++column) {
            solver_.inject(column, row, thickness(along(column), across(row)) / cosine_, 0, 0);
        }
    }
}

double GridIncline::along(int column) const {
    return from_ + (column + 0.5) * solver_.geometry().cell / cosine_;
}
double GridIncline::across(int row) const {
    return (row + 0.5) * solver_.geometry().cell - width_ / 2;
}
double GridIncline::thickness(int column, int row) const {
    return solver_.depth_at(column, row) * cosine_;
}
double GridIncline::velocity(int column, int row) const {
    return solver_.u_at(column, row) / cosine_;
}

void GridIncline::set_velocity(double velocity) {
    for (int row = 0; row < rows(); ++row) {
        for (int column = 0; column < columns(); ++column) solver_.set_velocity(column, row, velocity * cosine_, 0);
    }
}

std::string GridIncline::advance_to(double time, const Watch& watch) {
    while (solver_.time() < time - 1e-9) {
        if (watch.stopped()) return "stopped by the user";
        if (const Status s = solver_.advance(time - solver_.time()); !s) return s.error().message;
    }
    return "";
}

}  // namespace talus::validate
