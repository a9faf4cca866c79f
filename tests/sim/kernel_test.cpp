#include "sim/physics/kernel.hpp"

#include <gtest/gtest.h>

#include "sim/physics/boundary_table.hpp"
#include "sim/physics/viscosity.hpp"
#include "sim/sources/seed.hpp"

namespace talus::sim {
namespace {

const params::KernelChoice all_kernels[] = {params::KernelChoice::wendland_c2, params::KernelChoice::cubic_spline,
                                            params::KernelChoice::spiky, params::KernelChoice::poly6_spiky};

TEST(Kernel, integrates_to_one_over_its_support) {
    for (const params::KernelChoice choice : all_kernels) {
        with_kernel(choice, [](auto kernel) {
            double sum = 0;
            const int steps = 4000;
            for (int i = 0; i < steps; ++i) {
                const double q = (i + 0.5) / steps;
                sum += 4 * std::numbers::pi * q * q * kernel.value(q) / steps;
            }
            EXPECT_NEAR(sum, 1, 1e-6);
        });
    }
}

TEST(Kernel, slope_is_the_derivative_of_its_value) {
    for (const params::KernelChoice choice :
         {params::KernelChoice::wendland_c2, params::KernelChoice::cubic_spline, params::KernelChoice::spiky}) {
        with_kernel(choice, [](auto kernel) {
            for (double q = 0.05; q < 0.99; q += 0.045) {
                const double difference = (kernel.value(q + 1e-6) - kernel.value(q - 1e-6)) / 2e-6;
                EXPECT_NEAR(kernel.slope_over_q(q) * q, -difference, 1e-4);
            }
        });
    }
}

TEST(Kernel, published_pair_takes_its_gradient_from_spiky) {
    EXPECT_EQ(kernels::Poly6Spiky::value(0.3), kernels::Poly6::value(0.3));
    EXPECT_EQ(kernels::Poly6Spiky::slope_over_q(0.3), kernels::Spiky::slope_over_q(0.3));
}

TEST(Kernel, calibrated_volume_gives_the_rest_lattice_rest_density) {
    for (const params::KernelChoice choice : all_kernels) {
        const double spacing = 0.4, r = 2.2 * spacing;
        const Kernel kernel = make_kernel(choice, spacing, r);
        double sum = 0;
        with_kernel(choice, [&](auto k) {
            for (int x = -3; x <= 3; ++x) {
                for (int y = -3; y <= 3; ++y) {
                    for (int z = -3; z <= 3; ++z) {
                        const double q = spacing * std::sqrt(double(x * x + y * y + z * z)) / r;
                        if (q < 1) sum += kernel.particle_volume * k.value(q) / (r * r * r);
                    }
                }
            }
        });
        EXPECT_NEAR(sum, 1, 1e-12);
    }
}

TEST(BoundaryTable, gives_the_first_layer_of_a_rest_lattice_rest_density) {
    const double spacing = 0.5, r = 2.2 * spacing;
    const Kernel kernel = make_kernel(params::KernelChoice::wendland_c2, spacing, r);
    const BoundaryTable table(kernel, spacing);
    double sum = table.at(spacing / 2).density;
    for (int x = -3; x <= 3; ++x) {
        for (int y = -3; y <= 3; ++y) {
            for (int z = 0; z <= 3; ++z) {
                const double q = spacing * std::sqrt(double(x * x + y * y + z * z)) / r;
                if (q < 1) sum += kernel.particle_volume * kernels::WendlandC2::value(q) / (r * r * r);
            }
        }
    }
    EXPECT_NEAR(sum, 1, 1e-3);
}

TEST(BoundaryTable, slope_is_the_derivative_of_the_density_share) {
    const Kernel kernel = make_kernel(params::KernelChoice::wendland_c2, 0.5, 1.1);
    const BoundaryTable table(kernel, 0.5);
    for (double d = -1.0; d < 1.05; d += 0.07) {
        const double difference = (table.at(d + 0.01).density - table.at(d - 0.01).density) / 0.02;
        EXPECT_NEAR(table.at(d).slope, difference, 0.01);
    }
}

TEST(BoundaryTable, is_half_its_full_share_on_the_plane_and_nothing_beyond_the_support) {
    const Kernel kernel = make_kernel(params::KernelChoice::wendland_c2, 0.5, 1.1);
    const BoundaryTable table(kernel, 0.5);
    EXPECT_NEAR(table.at(0.0).density / table.at(-2.0).density, 0.5, 1e-3);
    EXPECT_EQ(table.at(1.1).density, 0);
    EXPECT_EQ(table.at(std::nan("")).density, 0) << "ground without data presses on nothing";
}

TEST(Viscosity, smoothing_is_proportional_to_the_step_and_never_overshoots) {
    EXPECT_NEAR(step_smoothing(0.1, 1.0 / 60), 0.1, 1e-12);
    EXPECT_NEAR(step_smoothing(0.1, 1.0 / 240), 0.025, 1e-12);
    EXPECT_EQ(step_smoothing(0.9, 1.0 / 20), 1);
}

TEST(Viscosity, may_be_given_as_kinematic_and_is_then_the_same_at_every_spacing) {
    params::MaterialSpec material;
    material.kinematic_viscosity = 0.05;
    const Model coarse = make_model(material, {}, 0.4), fine = make_model(material, {}, 0.2);
    EXPECT_NEAR(coarse.kinematic_viscosity, 0.05, 1e-12);
    EXPECT_NEAR(fine.kinematic_viscosity, 0.05, 1e-12);
    EXPECT_NEAR(fine.viscosity / coarse.viscosity, 4, 1e-9);
}

TEST(Viscosity, converts_to_a_kinematic_viscosity_and_back) {
    const double moment = make_kernel(params::KernelChoice::wendland_c2, 0.4, 0.88).second_moment;
    EXPECT_NEAR(smoothing_viscosity(kinematic_viscosity(0.1, moment), moment), 0.1, 1e-12);
}

}  // namespace
}  // namespace talus::sim
