#include <cmath>
#include <numbers>

#include "grids.hpp"

namespace talus::test {
namespace {

/// A dam across a uniform slope, normal to it, that breaks at once: Ritter (1892) on level ground without friction,
/// Mangeney et al. (2000, "Analytical solution for testing debris avalanche numerical models") on a slope. Along the
/// slope, with its normal depth, the solution is Ritter's in a frame that accelerates by g (sin - mu cos).
struct DamBreak {
    double slope, friction, depth, time;

    [[nodiscard]] double acceleration() const { return gravity * (std::sin(slope) - friction * std::cos(slope)); }
    [[nodiscard]] double wave() const { return std::sqrt(gravity * std::cos(slope) * depth); }
    [[nodiscard]] double depth_at(double along) const {
        const double moved = along - acceleration() * time * time / 2, x = moved / time;
        if (x < -wave()) return depth;
        if (x > 2 * wave()) return 0;
        return (2 * wave() - x) * (2 * wave() - x) / (9 * gravity * std::cos(slope));
    }
};

/// Error of depth (L2, relative) with `cells` over 100 m.
double dam_break_error(const DamBreak& dam, int cells) {
    const double length = 100, from = 50, cosine = std::cos(dam.slope);
    const auto bed = grid_of(cells, 1, length / cells, [&](double x, double) { return -x * std::tan(dam.slope); });
    depth::Material material;
    material.friction_coefficient = dam.friction;
    depth::Solver solver(bed, material, {}, depth::Edges::continued);
    solver.add(
        grid_of<float>(cells, 1, length / cells, [&](double x, double) { return x < from ? dam.depth / cosine : 0; }));
    advance_until(solver, dam.time);
    double error = 0, whole = 0;
    for (int column = 0; column < cells; ++column) {
        const double x = bed.geometry.centre(column, 0).x;
        if (x < 25) continue;  // the upper end of the debris, which the solution does not have
        const double exact = dam.depth_at((x - from) / cosine), found = solver.depth_at(column, 0) * cosine;
        error += (found - exact) * (found - exact);
        whole += exact * exact;
    }
    return std::sqrt(error / whole);
}

constexpr double degree = std::numbers::pi / 180;

TEST(DamBreak, follows_ritter_on_level_ground) {
    EXPECT_LT(dam_break_error({0, 0, 2, 3}, 200), 0.02);
    EXPECT_LT(dam_break_error({0, 0, 2, 3}, 400), 0.75 * dam_break_error({0, 0, 2, 3}, 200));
}

TEST(DamBreak, follows_the_exact_solution_on_slopes) {
    EXPECT_LT(dam_break_error({20 * degree, std::tan(10 * degree), 1, 3}, 200), 0.02);
    EXPECT_LT(dam_break_error({30 * degree, std::tan(20 * degree), 1, 3}, 200), 0.02);
    EXPECT_LT(dam_break_error({40 * degree, std::tan(30 * degree), 1, 3}, 200), 0.035);
}

TEST(DamBreak, is_the_same_in_every_direction) {
    const auto along = [](double angle) {
        const auto bed = grid_of(60, 60, 1, [](double, double) { return 0.0; });
        depth::Solver solver(bed, {});
        solver.add(grid_of<float>(60, 60, 1, [&](double x, double y) {
            return (x - 30) * std::cos(angle) + (y - 30) * std::sin(angle) < 0 ? 1 : 0;
        }));
        advance_until(solver, 2);
        return solver;
    };
    const depth::Solver east = along(0), north = along(std::numbers::pi / 2), west = along(std::numbers::pi);
    for (int k = 20; k < 40; ++k) {
        EXPECT_NEAR(east.depth_at(k, 30), north.depth_at(30, k), 1e-5);
        EXPECT_NEAR(east.depth_at(k, 30), west.depth_at(59 - k, 30), 1e-5);
        EXPECT_NEAR(east.u_at(k, 30), -west.u_at(59 - k, 30), 1e-4);
    }
}

}  // namespace
}  // namespace talus::test
