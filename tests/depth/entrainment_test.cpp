#include "depth/entrainment.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "grids.hpp"

namespace talus::depth {
namespace {

Grid<double> plane(int columns, double cell, double slope) {
    Grid<double> bed({0, 0, cell, columns, 4});
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < columns; ++column) bed.at(column, row) = -column * cell * slope;
    }
    return bed;
}

Entrainment laid(const Grid<double>& ground, const terrain::BedMaterial& material, double depth) {
    terrain::Bed bed;
    bed.materials = {material};
    bed.material_at.assign(ground.values.size(), 1);
    bed.depth.assign(ground.values.size(), static_cast<float>(depth));
    bed.eroded.assign(ground.values.size(), 0);
    return Entrainment(bed);
}

double total(const Solver& solver, const Entrainment& bed) {
    double ground = 0;
    for (const float eroded : bed.bed().eroded) ground += eroded;
    return solver.volume() + solver.volume_left() - ground * solver.geometry().cell * solver.geometry().cell;
}

TEST(Entrainment, grows_a_slab_by_the_law_and_takes_its_speed) {
    const double slope = std::tan(0.5), friction = 0.4, rate = 0.01;
    const Grid<double> ground = plane(500, 0.5, slope);
    Material material;
    material.friction_coefficient = friction;
    Solver solver(ground, material, {}, Edges::continued);
    for (int row = 0; row < 4; ++row) {
        for (int column = 10; column < 60; ++column) solver.inject(column, row, 0.3, 0, 0);
    }
    terrain::BedMaterial growing;
    growing.growth_rate = rate;
    Entrainment bed = laid(ground, growing, 1);
    const double before = solver.volume();
    double entrained = 0;
    while (solver.time() < 6 - 1e-9) {
        ASSERT_TRUE(solver.advance(6 - solver.time()));
        entrained += bed.entrain(solver);
    }
    // M' = E P, P' = M a, for any shape: M / M0 = cosh(t sqrt(E a)).
    const double acceleration = test::gravity * (std::sin(0.5) - friction * std::cos(0.5));
    const double grown = std::cosh(6 * std::sqrt(rate * acceleration));
    EXPECT_NEAR(solver.volume() / before, grown, 0.01 * grown);
    EXPECT_NEAR(entrained, (grown - 1) * before, 0.05 * (grown - 1) * before);
    EXPECT_NEAR(total(solver, bed), before, 5e-6 * before);
    double momentum = 0;
    for (int column = 0; column < 500; ++column) momentum += solver.depth_at(column, 1) * solver.u_at(column, 1);
    double mass = 0;
    for (int column = 0; column < 500; ++column) mass += solver.depth_at(column, 1);
    const double law = std::sqrt(acceleration / rate) * std::tanh(6 * std::sqrt(rate * acceleration));
    EXPECT_NEAR(momentum / mass / std::cos(0.5), law, 0.02 * law);
}

TEST(Entrainment, ends_where_the_bed_ends) {
    const Grid<double> ground = plane(200, 0.5, 0.6);
    Solver solver(ground, {}, {}, Edges::continued);
    for (int row = 0; row < 4; ++row) {
        for (int column = 10; column < 30; ++column) solver.inject(column, row, 1, 3, 0);
    }
    terrain::BedMaterial growing;
    growing.growth_rate = 1;
    Entrainment bed = laid(ground, growing, 0.1);
    const float high = solver.bed_at(40, 1);
    while (solver.time() < 4) {
        ASSERT_TRUE(solver.advance(0.1));
        (void)bed.entrain(solver);
    }
    EXPECT_NEAR(bed.bed().eroded[200 + 40], 0.1, 1e-4);
    EXPECT_LE(bed.bed().eroded[200 + 40], 0.1F);
    EXPECT_NEAR(high - solver.bed_at(40, 1), 0.1, 1e-4);
    EXPECT_EQ(bed.bed().eroded[200], 0) << "debris never came there";
}

TEST(Entrainment, by_shear_sinks_at_its_rate_down_to_what_the_stress_reaches) {
    const Grid<double> ground = plane(200, 1, 0.5);
    Solver solver(ground, {}, {}, Edges::continued);
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 200; ++column) solver.inject(column, row, 1, 2, 0);
    }
    terrain::BedMaterial shear;
    shear.law = params::EntrainmentLaw::shear;
    shear.critical_shear_stress = 1000;
    shear.erosion_rate = 0.02;
    shear.depth_per_shear = 1e-5;
    Entrainment bed = laid(ground, shear, 1);
    const auto run_to = [&](double end) {
        while (solver.time() < end - 1e-9) {
            ASSERT_TRUE(solver.advance(end - solver.time()));
            (void)bed.entrain(solver);
        }
    };
    const std::size_t middle = 200 + 160;
    run_to(1);
    EXPECT_NEAR(bed.bed().eroded[middle], 0.02, 1e-4);
    run_to(6);
    // rho g h cos sin = 2000 x 9.81 x 1 x 0.5 / 1.25, for a depth that grows by what it erodes.
    const double per_depth = 1e-5 * 2000 * test::gravity * 0.4, reached = (per_depth - 0.01) / (1 - per_depth);
    EXPECT_NEAR(bed.bed().eroded[middle], reached, 0.01 * reached);
}

}  // namespace
}  // namespace talus::depth
