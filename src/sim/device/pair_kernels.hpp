#pragma once

#include <cstdint>

#include "sim/device/one_particle.hpp"
#include "sim/device/views.hpp"
#include "sim/stages/pair_friction.hpp"

/// Pairwise position-based dynamics.
namespace talus::sim::device {

template <class Smoothing>
struct FindTolerated {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const { stages::find_tolerated(OneParticle{d, i}, kernel); }
};

template <class Smoothing>
struct UpdateMultipliers {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            stages::update_multipliers(OneParticle{d, i}, kernel);
        } else {
            d.work.compression[i] = 0;
            d.work.moved[i].w = 0;
        }
    }
};

template <class Smoothing>
struct ApplyPairs {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            stages::apply_pairs(OneParticle{d, i}, kernel);
        } else {
            d.work.corrected[i] = d.work.moved[i].vector();
        }
    }
};

}  // namespace talus::sim::device
