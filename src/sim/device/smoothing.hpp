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

}  // namespace talus::sim::device
