#pragma once

#include <cstdint>

#include "sim/device/particle_kernels.hpp"
#include "sim/device/smoothing.hpp"
#include "sim/device/views.hpp"
#include "sim/physics/density.hpp"
#include "sim/physics/stress.hpp"

/// The default method: density and internal friction as a stress per particle that persists between steps. Gradients of
/// pairs are computed anew in every sum: on a card that costs less than reading them, and a tenth of the memory.
namespace talus::sim::device {

/// What apply() reads of a particle.
TALUS_DEVICE inline StressRow stress_row(float p, const Deviator<float>& s) {
    return {p + s.xx, s.xy, s.xz, p + s.yy, s.yz, p - s.xx - s.yy, 0, p};
}

/// This step starts from the multipliers and stresses of the last one, scaled by the square of the time steps' ratio.
/// Held debris keeps its values for its start and presses on nothing.
TALUS_DEVICE inline void start_warm(const Data& d, std::uint32_t i, float scale) {
    const float multiplier = d.state.multiplier[i] * scale;
    const Deviator<float> stress = d.state.stress[i] * scale;
    d.state.multiplier[i] = multiplier;
    d.state.stress[i] = stress;
    d.work.change[i] = d.state.held[i] != 0 ? StressRow{} : stress_row(multiplier, stress);
}

/// Density constraints and their gradients at the predicted positions.
template <class Smoothing>
struct Linearise {
    Data d;
    PairKernel<Smoothing> pair;
    float softness{}, warm_scale{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const Vec3<float> p = d.work.place[i].vector(), moved = d.work.moved[i].vector();
        PairSums sums;
        sums.density = pair.value(0);
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            const Vec3<float> gradient = sums.add(pair, p - d.work.place[j].vector());
            sums.divergence += dot(d.work.moved[j].vector() - moved, gradient);
        });
        const BoundaryShare boundary = sample_boundary_of(d, i, p, moved);
        const auto constraint = linearise_density(d.model, sums, boundary, moved, softness);
        d.work.constraint[i] = constraint;
        d.work.tolerated_compression[i] = compression_before(constraint);
        start_warm(d, i, warm_scale);
    }
};

/// Sleeping debris only presses on its neighbours.
struct PressAsleep {
    Data d;
    float warm_scale{};
    std::uint32_t awake{};

    TALUS_DEVICE void operator()(std::uint32_t k) const { start_warm(d, awake + k, warm_scale); }
};

/// It contributes no further changes in this step.
struct ClearAsleep {
    Data d;
    std::uint32_t awake{};

    TALUS_DEVICE void operator()(std::uint32_t k) const { d.work.change[awake + k] = {}; }
};

/// Eqs. (1) and (2), and the stress that resists the shear of this step.
template <class Smoothing>
struct SolveStress {
    Data d;
    PairKernel<Smoothing> pair;
    float factor{}, cohesion{}, grain_size{};
    bool by_particle{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) {
            d.work.compression[i] = 0;
            d.work.change[i] = {};
            return;
        }
        const Vec3<float> p = d.work.place[i].vector(), moved = d.work.moved[i].vector();
        DisplacementGradient<float> deformation;
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            deformation.add(d.work.moved[j].vector() - moved, pair.gradient(p - d.work.place[j].vector()));
        });
        const DensityConstraint<float> constraint = d.work.constraint[i];
        const float density = constraint.start - deformation.divergence() +
                              boundary_change(Vec3<float>(d.work.boundary_gradient[i]), moved);
        const float before = d.state.multiplier[i];
        const float after =
            next_multiplier(before, density - larger(0.0f, constraint.start), constraint.gradient_square, factor);
        const Deviator<float> stress_before = d.state.stress[i];
        const Resistance held = by_particle ? d.work.resistance[i] : Resistance{};
        const InertialFriction& inertial = d.model.inertial_friction;
        if (inertial.on) {
            add_ground_shear(deformation, moved, d.work.plane[i].normal, d.work.plane[i].slope, held.ground_shear);
        }
        const Deviator<float> shear = deformation.shear();
        const float pressure = -after * held.effective_share;
        auto friction = static_cast<float>(d.model.internal_friction_coefficient);
        if (inertial.on) {
            friction = inertial_friction(friction, static_cast<float>(inertial.rise), static_cast<float>(inertial.half),
                                         grain_size, shear, pressure);
        }
        const float limit = d.model.cohesion > 0 ? strength_limit_square(friction, pressure, cohesion)
                                                 : friction_limit_square(friction, pressure);
        const Deviator<float> stress = next_stress(stress_before, shear, limit, constraint.pair_square, factor);
        d.state.multiplier[i] = after;
        d.state.stress[i] = stress;
        d.work.compression[i] = larger(0.0f, density - constraint.surface_share);
        d.work.change[i] = stress_row(after - before, stress - stress_before);
    }
};

/// u_i += sum_j [(d lambda_i + d lambda_j) I + ds_i + ds_j] V grad W, equal and opposite for the two particles of a
/// pair.
template <class Smoothing>
struct ApplyStress {
    Data d;
    PairKernel<Smoothing> pair;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const Vec3<float> moved = d.work.moved[i].vector();
        if (!d.state.moves(i)) {
            d.work.corrected[i] = moved;
            return;
        }
        const Vec3<float> p = d.work.place[i].vector();
        const StressRow own = d.work.change[i];
        Vec3<float> correction;
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            const Vec3<float> gradient = pair.gradient(p - d.work.place[j].vector());
            const StressRow other = d.work.change[j];
            const float xy = own.xy + other.xy, xz = own.xz + other.xz, yz = own.yz + other.yz;
            correction += {dot({own.xx + other.xx, xy, xz}, gradient), dot({xy, own.yy + other.yy, yz}, gradient),
                           dot({xz, yz, own.zz + other.zz}, gradient)};
        });
        correction += boundary_correction(Vec3<float>(d.work.boundary_gradient[i]), own.pressure);
        d.work.corrected[i] = moved + correction;
    }
};

/// Density above that at rest, as a multiplier.
struct FindSpread {
    Data d;
    float factor{}, share{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const float excess = spread_in_step(d.work.compression[i], share);
        d.work.moved[i].w = next_multiplier(0.0f, excess, d.work.constraint[i].gradient_square, factor);
    }
};

/// The shift that reduces it.
template <class Smoothing>
struct Spread {
    Data d;
    PairKernel<Smoothing> pair;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const Vec3<float> p = d.work.place[i].vector();
        const float own = d.work.moved[i].w;
        Vec3<float> shift = boundary_correction(Vec3<float>(d.work.boundary_gradient[i]), own);
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            shift += pair.gradient(p - d.work.place[j].vector()) * (own + d.work.moved[j].w);
        });
        d.work.shift[i] = shift;
    }
};

}  // namespace talus::sim::device
