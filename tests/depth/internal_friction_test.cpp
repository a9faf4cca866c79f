#include "depth/internal_friction.hpp"

#include <algorithm>
#include <cmath>

#include "grids.hpp"
#include "same_bits.hpp"

namespace talus::test {
namespace {

constexpr double inside = 0.4, depth_of_sheet = 1.5, short_time = 1e-3;
constexpr int sheet_columns = 40, sheet_rows = 40, sheet_middle = sheet_columns / 2;

void advance_with(depth::Solver& solver, double coefficient, double time) {
    depth::InternalFriction friction(solver, coefficient);
    while (solver.time() < time - 1e-9) {
        ASSERT_TRUE(solver.advance(time - solver.time()).ok());
        friction.resist(solver);
    }
}

struct Momentum {
    double x = 0, y = 0;  ///< per density, m3/s
};

/// Of a row of the western half of a level sheet of cells of 1 m whose halves have opposite velocities, after a short
/// time.
Momentum of_western_half(double internal_friction, double u, double v, double pore_pressure_ratio = 0) {
    depth::Material material;
    material.pore_pressure_ratio = pore_pressure_ratio;
    depth::Solver solver(grid_of(sheet_columns, sheet_rows, 1, [](double, double) { return 0.0; }), material);
    for (int row = 0; row < sheet_rows; ++row) {
        for (int column = 0; column < sheet_columns; ++column) {
            const double side = column < sheet_middle ? 1 : -1;
            solver.inject(column, row, depth_of_sheet, side * u, side * v);
        }
    }
    advance_with(solver, internal_friction, short_time);
    Momentum sum;
    for (int column = 5; column < sheet_middle; ++column) {  // edges of the grid are open
        sum.x += double{solver.depth_at(column, sheet_rows / 2)} * solver.u_at(column, sheet_rows / 2);
        sum.y += double{solver.depth_at(column, sheet_rows / 2)} * solver.v_at(column, sheet_rows / 2);
    }
    return sum;
}

/// m3/s2, over the depth and per width.
constexpr double weight = gravity * depth_of_sheet * depth_of_sheet / 2;

TEST(InternalFriction, resists_shear_by_its_share_of_the_pressure) {
    const auto lost = [](double pore_pressure_ratio) {
        const double with = of_western_half(inside, 0, 1, pore_pressure_ratio).y;
        return (of_western_half(0, 0, 1, pore_pressure_ratio).y - with) / short_time;
    };
    EXPECT_NEAR(lost(0), inside * weight, 0.01 * inside * weight);
    EXPECT_NEAR(lost(0.5), inside * weight / 2, 0.01 * inside * weight);
}

TEST(InternalFriction, presses_converging_and_holds_parting_debris_as_rankine_has_it) {
    const auto held = [](double u) {
        return (of_western_half(0, u, 0).x - of_western_half(inside, u, 0).x) / short_time;
    };
    const double passive = (1 + inside) / (1 - inside), active = 1 / passive;
    EXPECT_NEAR(held(0.2), (passive - 1) * weight, 0.01 * (passive - 1) * weight);
    EXPECT_NEAR(held(-0.2), (active - 1) * weight, 0.01 * (1 - active) * weight);
}

/// A heap that spreads on level ground: its momentum along x and y, and its energy of motion.
struct Motion {
    double x = 0, y = 0, energy = 0;
};
depth::Solver heap_after(double time, double internal_friction) {
    depth::Solver solver(grid_of(60, 60, 1, [](double, double) { return 0.0; }), {});
    for (int row = 20; row < 40; ++row) {
        for (int column = 20; column < 40; ++column) {
            solver.inject(column, row, 1 + 0.05 * (column - 20), 0.3 * (row - 30), -0.1 * (column - 30));
        }
    }
    advance_with(solver, internal_friction, time);
    return solver;
}
Motion of_heap(double internal_friction) {
    const depth::Solver solver = heap_after(0.7, internal_friction);
    Motion sum;
    for (int row = 0; row < 60; ++row) {
        for (int column = 0; column < 60; ++column) {
            const double h = solver.depth_at(column, row), u = solver.u_at(column, row), v = solver.v_at(column, row);
            sum.x += h * u;
            sum.y += h * v;
            sum.energy += h * (u * u + v * v) / 2;
        }
    }
    return sum;
}

TEST(InternalFriction, keeps_momentum_and_takes_energy) {
    const Motion free = of_heap(0), resisting = of_heap(inside);
    EXPECT_NEAR(resisting.x, free.x, 1e-3 * std::sqrt(free.energy * 600));
    EXPECT_NEAR(resisting.y, free.y, 1e-3 * std::sqrt(free.energy * 600));
    EXPECT_LT(resisting.energy, 0.8 * free.energy);
}

TEST(InternalFriction, has_the_same_bits_on_any_number_of_threads_and_any_instruction_set) {
    expect_same_bits([] { return heap_after(0.7, inside); });
}

/// m/s, the fastest of all cells.
double fastest_wave(const depth::Solver& solver) {
    double fastest = 0;
    for (int row = 0; row < solver.geometry().rows; ++row) {
        for (int column = 0; column < solver.geometry().columns; ++column) {
            const float u = std::abs(solver.u_at(column, row)), v = std::abs(solver.v_at(column, row));
            const double depth = solver.depth_at(column, row);
            if (depth > 1e-3) fastest = std::max(fastest, static_cast<double>(u + v) + 2 * std::sqrt(gravity * depth));
        }
    }
    return fastest;
}

TEST(InternalFriction, makes_the_next_step_as_short_as_what_it_drags_along_needs) {
    // Deep debris that stands, beside a shallow stream which draws it along.
    depth::Solver solver(grid_of(40, 40, 1, [](double, double) { return 0.0; }), {});
    for (int row = 0; row < 40; ++row) {
        for (int column = 0; column < 40; ++column) {
            solver.inject(column, row, row < 20 ? 2.2 : 2, row < 20 ? 0 : 0.5, 0);
        }
    }
    depth::InternalFriction friction(solver, inside);
    double raised = 0;
    for (int step = 0; step < 20; ++step) {
        ASSERT_TRUE(solver.advance(1e-3).ok());
        const double before = solver.signal();
        friction.resist(solver);
        EXPECT_GE(solver.signal(), fastest_wave(solver)) << "step " << step;
        raised += solver.signal() - before;
    }
    EXPECT_GT(raised, 1e-4) << "the test shows nothing";
}

TEST(InternalFriction, ends_at_a_structure) {
    // A stream beside debris that moves the other way, on top of a row of structures or of ground as high.
    const auto lost = [](bool built) {
        const auto speed = [&](double coefficient) {
            const auto high = [](int row) { return row == 10; };
            depth::GroundValues ground;
            for (int k = 0; k < 40 * 20; ++k) ground.structure.push_back(built && high(k / 40) ? 1.0F : 0.0F);
            depth::Solver solver(
                grid_of(40, 20, 1, [&](double, double y) { return high(static_cast<int>(y)) ? 0.5 : 0.0; }), {},
                ground);
            for (int row = 0; row < 20; ++row) {
                for (int column = 0; column < 40; ++column) solver.inject(column, row, 1, high(row) ? -1 : 1, 0);
            }
            advance_with(solver, coefficient, short_time);
            return static_cast<double>(solver.u_at(20, 9));
        };
        return speed(0) - speed(inside);
    };
    EXPECT_LT(lost(true), 1e-6) << "what falls off slows it, which the rest of the stream resists";
    EXPECT_GT(lost(false), 1e-3);
}

}  // namespace
}  // namespace talus::test
