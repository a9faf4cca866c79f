#include <cmath>
#include <cstddef>
#include <limits>

#include "depth/formulas.hpp"
#include "grids.hpp"

namespace talus::test {
namespace {

/// Speed along the ground in the middle of a sheet, m/s, `normal_depth` thick on a slope, after a time. The slope falls
/// to the south-east, the sheet goes on beyond the part that is looked at.
double sheet_speed(double slope, double normal_depth, double time, const depth::Material& material,
                   bool oblique = false) {
    const double s = std::tan(slope) / (oblique ? std::sqrt(2.0) : 1);
    const int edge = oblique ? 160 : 1;
    const auto bed = grid_of(160, edge, 1, [&](double x, double y) { return oblique ? s * (y - x) : -s * x; });
    depth::Solver solver(bed, material, {}, oblique ? depth::Edges::open : depth::Edges::continued);
    solver.add(grid_of<float>(160, edge, 1, [&](double, double) { return normal_depth / std::cos(slope); }));
    advance_until(solver, time);
    const int middle = 80, row = edge / 2;
    const double u = solver.u_at(middle, row), v = solver.v_at(middle, row);
    const double w = u * solver.slope_x_at(middle, row) + v * solver.slope_y_at(middle, row);
    return std::sqrt(u * u + v * v + w * w);
}

TEST(Sheet, accelerates_by_gravity_along_the_slope_less_friction) {
    for (const double slope : {0.2, 0.5, 0.8}) {
        depth::Material material;
        material.friction_coefficient = 0.15;
        const double exact = gravity * (std::sin(slope) - 0.15 * std::cos(slope));
        EXPECT_NEAR(sheet_speed(slope, 1, 1, material), exact, 2e-4 * exact);
        EXPECT_NEAR(sheet_speed(slope, 1, 1, material, true), exact, 2e-4 * exact);
    }
}

TEST(Sheet, reaches_the_speed_of_voellmy) {
    depth::Material material;
    material.friction_coefficient = 0.1;
    material.laws.turbulent_friction = 100;
    const double slope = 0.35, exact = std::sqrt(100 * 0.8 * (std::sin(slope) - 0.1 * std::cos(slope)));
    EXPECT_NEAR(sheet_speed(slope, 0.8, 12, material), exact, 1e-3 * exact);
}

TEST(Sheet, reaches_the_speed_of_manning) {
    // v = h^(2/3) sqrt(sin) / n is Voellmy's with xi = h^(1/3) / n^2.
    const double n = 0.06, slope = 0.3, thickness = 0.5;
    depth::Material material;
    material.laws.turbulent_friction = 1 / (n * n);
    material.laws.turbulent_thickness = 1;
    const double exact = std::pow(thickness, 2.0 / 3) * std::sqrt(std::sin(slope)) / n;
    EXPECT_NEAR(sheet_speed(slope, thickness, 8, material), exact, 2e-3 * exact);
}

TEST(Sheet, reaches_the_speed_of_viscous_flow) {
    depth::Material material;
    material.laws.laminar_viscosity = 0.3;
    const double slope = 0.3, thickness = 0.5, exact = gravity * std::sin(slope) * thickness * thickness / (3 * 0.3);
    EXPECT_NEAR(sheet_speed(slope, thickness, 6, material), exact, 1e-3 * exact);
}

TEST(Sheet, has_the_viscosity_of_the_zone_that_it_flows_over) {
    const double slope = 0.3, thickness = 0.5, viscosity = 0.3;
    const auto bed = grid_of(160, 1, 1, [&](double x, double) { return -std::tan(slope) * x; });
    depth::GroundValues ground;
    ground.laminar_viscosity.assign(160, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t k = 60; k < 160; ++k) ground.laminar_viscosity[k] = static_cast<float>(viscosity);
    depth::Material material;
    material.laws.laminar_viscosity = 0.6;
    depth::Solver solver(bed, material, ground, depth::Edges::continued);
    solver.add(grid_of<float>(160, 1, 1, [&](double, double) { return thickness / std::cos(slope); }));
    advance_until(solver, 2);
    const auto speed = [&](int column) { return solver.u_at(column, 0) / std::cos(slope); };
    const auto exact = [&](double nu) { return gravity * std::sin(slope) * thickness * thickness / (3 * nu); };
    EXPECT_NEAR(speed(130), exact(viscosity), 0.01 * exact(viscosity));
    EXPECT_NEAR(speed(30), exact(0.6), 0.01 * exact(0.6)) << "as elsewhere";
}

TEST(Sheet, reaches_the_speed_of_bingham) {
    const double slope = 0.3, thickness = 0.5, stress = 2000 * gravity * std::sin(slope) * thickness;
    for (const double share : {0.2, 0.5, 0.8}) {  // of the stress on the ground
        depth::Material material;
        material.rest_density = 2000;
        material.laws.laminar_viscosity = 0.3;
        material.cohesion = share * stress;
        const double exact = stress * thickness * (1 - share) * (1 - share) * (2 + share) / (6 * 2000 * 0.3);
        EXPECT_NEAR(sheet_speed(slope, thickness, 10, material), exact, 0.01 * exact) << share;
    }
    depth::Material material;
    material.rest_density = 2000;
    material.laws.laminar_viscosity = 0.3;
    material.cohesion = 1.01 * stress;
    EXPECT_EQ(sheet_speed(slope, thickness, 10, material), 0);
}

depth::Material snow() {
    depth::Material material;
    material.friction_coefficient = 0.155;
    material.laws.samosat = {true, 0.222, 0.43, 0.05, 4.13};
    return material;
}

TEST(Sheet, reaches_the_speed_of_samosat) {
    // h = 0.1 m: ln 2 / 0.43 + 4.13 = 5.741970, its square 32.97022.
    const double thickness = 0.1, square = 32.97022;
    for (const double slope : {0.35, 0.5}) {
        const double normal = gravity * thickness * std::cos(slope);
        const double exact = sheet_speed(slope, thickness, 8, snow()), rs = exact * exact / normal;
        const double friction = 0.155 * normal * (1 + 0.222 / (0.222 + rs)), drag = exact * exact / square;
        EXPECT_NEAR((friction + drag) / (normal * std::tan(slope)), 1, 2e-3) << slope;
    }
}

TEST(Sheet, of_samosat_stays_below_twice_its_friction) {
    EXPECT_EQ(sheet_speed(std::atan(0.30), 0.5, 5, snow()), 0);
    EXPECT_EQ(sheet_speed(std::atan(0.30), 0.002, 5, snow()), 0) << "however thin it is";
    EXPECT_GT(sheet_speed(std::atan(0.32), 0.5, 5, snow()), 0.1);
    depth::Material even = snow();
    even.laws.samosat.fluidization = 0;
    EXPECT_GT(sheet_speed(std::atan(0.30), 0.5, 5, even), 0.1) << "friction is the same at rest";
}

TEST(Samosat, is_implicit_and_stops_debris_without_reversing_it) {
    depth::Resistance<double> r{};
    r.friction = 0.155;
    r.moving_friction.fluidization = 0.222;
    for (const double depth : {1e-4, 0.01, 1.0}) {
        r.inverse_turbulence = 1 / (gravity * 60);
        const double normal = gravity * depth * 0.8, stretch = 1 / std::sqrt(0.8);
        for (const double dt : {0.001, 0.1, 10.0}) {
            const auto after = [&](double momentum) {
                return depth::resisted(r, gravity, momentum, depth, normal, stretch, dt);
            };
            const double holds = dt * stretch * 2 * 0.155 * normal;
            EXPECT_EQ(after(0), 0);
            EXPECT_EQ(after(0.999 * holds), 0) << "friction at rest stops it";
            for (const double momentum : {1.5 * holds, 10 * holds, 1000 * depth}) {
                if (momentum <= holds) continue;
                const double left = after(momentum), speed = left / depth;
                EXPECT_GT(left, 0);
                EXPECT_LT(left, momentum);
                const double friction = 0.155 * (1 + 0.222 * normal / (0.222 * normal + speed * speed));
                const double taken = dt * stretch * (friction * normal + speed * speed / 60);
                EXPECT_NEAR(left + taken, momentum, 0.01 * momentum) << depth << ", " << dt;
            }
        }
    }
    EXPECT_GE(depth::resisted(r, gravity, 0.5, 0.0, 0.0, 1.0, 0.1), 0) << "no depth, no weight";
}

TEST(Sheet, is_relieved_by_pore_pressure) {
    depth::Material material;
    material.friction_coefficient = 0.4;
    material.pore_pressure_ratio = 0.5;
    const double slope = 0.4, exact = gravity * (std::sin(slope) - 0.2 * std::cos(slope));
    EXPECT_NEAR(sheet_speed(slope, 1, 1, material), exact, 2e-4 * exact);
}

/// Ground that turns level along an arc, without friction.
TEST(Arc, keeps_the_energy_of_debris) {
    const int cells = 400;
    const double cell = 0.5, radius = 120;
    const auto bed = grid_of(cells, 1, cell, [&](double x, double) {
        return x < 100 ? radius - std::sqrt(radius * radius - (100 - x) * (100 - x)) : 0;
    });
    depth::Solver solver(bed, {}, {}, depth::Edges::continued);
    solver.add(grid_of<float>(cells, 1, cell, [](double x, double) { return x > 16 && x < 24 ? 1 : 0; }));
    const auto energy = [&] {
        double sum = 0;
        for (int c = 0; c < cells; ++c) {
            const double h = solver.depth_at(c, 0), u = solver.u_at(c, 0), w = u * solver.slope_x_at(c, 0);
            sum += h * (gravity * (solver.bed_at(c, 0) + h / 2) + (u * u + w * w) / 2);
        }
        return sum;
    };
    const double start = energy();
    advance_until(solver, 7);
    EXPECT_NEAR(energy(), start, 0.01 * start);
    EXPECT_EQ(solver.volume_left(), 0);
}

}  // namespace
}  // namespace talus::test
