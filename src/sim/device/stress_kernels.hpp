#pragma once

#include <cstdint>

#include "sim/device/one_particle.hpp"
#include "sim/device/views.hpp"
#include "sim/stages/stress.hpp"

/// The default method: density and internal friction as a stress per particle.
namespace talus::sim::device {

template <class Smoothing>
struct Linearise {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const { stages::linearise(OneParticle{d, i}, kernel); }
};

/// Sleeping debris only presses on its neighbours.
struct PressAsleep {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t k) const { stages::warm_start(OneParticle{d, d.awake + k}); }
};

/// It contributes no further changes in this step.
struct ClearAsleep {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t k) const { d.work.change[d.awake + k] = {}; }
};

template <class Smoothing>
struct SolveStress {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            stages::solve_stress(PairedParticle<Smoothing>{{d, i}, kernel});
        } else {
            d.work.compression[i] = 0;
            d.work.change[i] = {};
        }
    }
};

template <class Smoothing>
struct ApplyStress {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const {
        if (d.state.moves(i)) {
            stages::apply_stress(PairedParticle<Smoothing>{{d, i}, kernel});
        } else {
            d.work.corrected[i] = d.work.moved[i].vector();
        }
    }
};

struct FindSpread {
    Data d;

    TALUS_DEVICE void operator()(std::uint32_t i) const { stages::find_spread(OneParticle{d, i}); }
};

template <class Smoothing>
struct Spread {
    Data d;
    stages::PairKernel<Smoothing> kernel;

    TALUS_DEVICE void operator()(std::uint32_t i) const { stages::spread(PairedParticle<Smoothing>{{d, i}, kernel}); }
};

}  // namespace talus::sim::device
