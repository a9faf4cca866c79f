#include "depth/entrainment.hpp"

#include <algorithm>
#include <cmath>

#include "sim/physics/erosion.hpp"

namespace talus::depth {

/// m of ground that comes loose in a step.
double Entrainment::loosened(const Solver& solver, const terrain::BedMaterial& material, std::size_t cell, double depth,
                             double speed, double square_slope) const {
    const double step = solver.time_step(), gravity = solver.material().gravity;
    if (material.law == params::EntrainmentLaw::growth) return material.growth_rate * depth * speed * step;
    // Slower debris than a tenth of the speed of a fall through its own depth erodes nothing.
    if (!(speed > 0.1 * std::sqrt(gravity * depth))) return 0;
    const double cosine = 1 / std::sqrt(1 + square_slope), sine = std::sqrt(square_slope) * cosine;
    return sim::eroded_by_shear(material, solver.material().rest_density, gravity, depth, cosine, sine,
                                bed_.eroded[cell] + loose_[cell], step);
}

double Entrainment::entrain(Solver& solver) {
    if (bed_.empty()) return 0;
    const GridGeometry& g = solver.geometry();
    double sum = 0;
    solver.for_each_active_row_in_turn([&](const CellRow& row) {
        for (int k = 0; k < row.last - row.first; ++k) {
            const std::size_t cell = g.index(row.first + k, row.row);
            if (bed_.material_at[cell] == 0 || !(row.depth[k] > 0)) continue;
            const double u = row.u[k], v = row.v[k], slope_x = row.slope_x[k], slope_y = row.slope_y[k];
            const double w = u * slope_x + v * slope_y, speed = std::sqrt(u * u + v * v + w * w);
            if (!(speed > 0)) continue;
            const double left = bed_.depth[cell] - bed_.eroded[cell];
            const terrain::BedMaterial& material = bed_.materials[bed_.material_at[cell] - 1];
            loose_[cell] +=
                loosened(solver, material, cell, row.depth[k], speed, slope_x * slope_x + slope_y * slope_y);
            loose_[cell] = std::min(loose_[cell], left);
            const double eroded = solver.erode(row.first + k, row.row, loose_[cell]);
            loose_[cell] -= eroded;
            bed_.eroded[cell] += static_cast<float>(eroded);
            sum += eroded;
        }
    });
    return sum * g.cell * g.cell;
}

}  // namespace talus::depth
