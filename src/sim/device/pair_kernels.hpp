#pragma once

#include <cstdint>

#include "sim/device/particle_kernels.hpp"
#include "sim/device/smoothing.hpp"
#include "sim/device/views.hpp"
#include "sim/physics/density.hpp"
#include "sim/physics/friction.hpp"

/// Pairwise position-based dynamics (docs/equations.md), eqs. (1) to (4): density and pair friction, both start from
/// zero in every step.
namespace talus::sim::device {

/// Compression present at the step's start may be undone only slowly, since a correction becomes velocity: the density
/// constraint tolerates the rest.
template <class Smoothing>
struct FindTolerated {
    Data d;
    PairKernel<Smoothing> pair;
    float undone{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const Vec3<float> p = d.state.position[i];
        float density = pair.value(0);
        d.neighbours.for_each(i, [&](std::uint32_t j) { density += pair.value(length(p - d.state.position[j])); });
        const float start = density + sample_boundary_of(d, i, p, {}).density - 1;
        d.work.tolerated_compression[i] = larger(0.0f, start - undone);
        d.state.multiplier[i] = 0;
        // The first contacts are resolved before the first iteration.
        sample_boundary_of(d, i, d.work.place[i].vector(), d.work.moved[i].vector());
    }
};

/// Debris resists compression only.
template <class Smoothing>
struct UpdateMultipliers {
    Data d;
    PairKernel<Smoothing> pair;
    float softness{}, factor{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (!d.state.moves(i)) {
            d.work.compression[i] = 0;
            d.work.moved[i].w = 0;
            return;
        }
        const Vec3<float> p = d.work.place[i].vector(), moved = d.work.moved[i].vector();
        PairSums sums;
        sums.density = pair.value(0);
        d.neighbours.for_each(i, [&](std::uint32_t j) { sums.add(pair, p - d.work.place[j].vector()); });
        const BoundaryShare boundary = sample_boundary_of(d, i, p, moved);
        const float compression = sums.density + boundary.density - 1;
        const float before = d.state.multiplier[i];
        const float after = next_multiplier(before, compression - d.work.tolerated_compression[i],
                                            gradient_square(sums, boundary, softness), factor);
        d.work.moved[i].w = after - before;
        d.state.multiplier[i] = after;
        d.work.compression[i] = larger(0.0f, compression);
    }
};

/// Friction between particles pressed together; equal and opposite for the two of a pair.
template <class Smoothing>
struct ApplyPairs {
    Data d;
    PairKernel<Smoothing> pair;
    float cap{};

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        const Row own = d.work.moved[i];
        if (!d.state.moves(i)) {
            d.work.corrected[i] = own.vector();
            return;
        }
        const Vec3<float> p = d.work.place[i].vector();
        Vec3<float> correction = boundary_correction(Vec3<float>(d.work.boundary_gradient[i]), own.w);
        d.neighbours.for_each(i, [&](std::uint32_t j) {
            const Vec3<float> separation = p - d.work.place[j].vector();
            const Row other = d.work.moved[j];
            const float square = dot(separation, separation), distance = sqrtf(square);
            const float push = (own.w + other.w) * pair.slope(distance);
            const float limit = larger(0.0f, push * distance) * cap;  // none between separating particles
            correction += separation * push +
                          pair_friction(separation, square, own.vector() - other.vector(), limit, pair.value(distance));
        });
        d.work.corrected[i] = own.vector() + correction;
    }
};

}  // namespace talus::sim::device
