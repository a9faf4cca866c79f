#pragma once

#include "sim/physics/kernel.hpp"

namespace talus::sim::device {

/// A smoothing kernel that is chosen while it runs: one branch per pair, the same for all. The usual kernel is compiled
/// by itself.
struct ChosenSmoothing {
    params::KernelChoice choice;

    [[nodiscard]] TALUS_DEVICE float value(float q) const {
        switch (choice) {
            case params::KernelChoice::cubic_spline:
                return kernels::CubicSpline::value(q);
            case params::KernelChoice::spiky:
                return kernels::Spiky::value(q);
            case params::KernelChoice::poly6_spiky:
                return kernels::Poly6Spiky::value(q);
            case params::KernelChoice::wendland_c2:
                break;
        }
        return kernels::WendlandC2::value(q);
    }
    [[nodiscard]] TALUS_DEVICE float slope_over_q(float q) const {
        switch (choice) {
            case params::KernelChoice::cubic_spline:
                return kernels::CubicSpline::slope_over_q(q);
            case params::KernelChoice::spiky:
                return kernels::Spiky::slope_over_q(q);
            case params::KernelChoice::poly6_spiky:
                return kernels::Poly6Spiky::slope_over_q(q);
            case params::KernelChoice::wendland_c2:
                break;
        }
        return kernels::WendlandC2::slope_over_q(q);
    }
};

/// The kernel of a pair, with its constants.
template <class Smoothing>
struct PairKernel {  // NOLINT(cppcoreguidelines-pro-type-member-init): the scale has a constructor
    Smoothing kernel;
    PairScale scale;

    /// V W at a distance.
    [[nodiscard]] TALUS_DEVICE float value(float distance) const {
        return kernel.value(scale.quotient(distance)) * scale.value_scale;
    }
    /// V grad W is this times the separation.
    [[nodiscard]] TALUS_DEVICE float slope(float distance) const {
        return kernel.slope_over_q(scale.quotient(distance)) * -scale.gradient_scale;
    }
    [[nodiscard]] TALUS_DEVICE Vec3<float> gradient(const Vec3<float>& separation) const {
        return separation * slope(length(separation));
    }
};

/// What linearise_density() takes from the neighbours.
struct PairSums {
    float density = 0, square = 0, divergence = 0;
    Vec3<float> gradient;

    /// Adds a pair; returns its gradient.
    template <class Smoothing>
    TALUS_DEVICE Vec3<float> add(const PairKernel<Smoothing>& pair, const Vec3<float>& separation) {
        const float distance_square = dot(separation, separation), distance = sqrtf(distance_square);
        const float slope = pair.slope(distance);
        const Vec3<float> own = separation * slope;
        density += pair.value(distance);
        square += slope * slope * distance_square;
        gradient += own;
        return own;
    }
};

}  // namespace talus::sim::device
