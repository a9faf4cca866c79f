#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/cpu/work.hpp"

namespace talus::sim::cpu {

/// Works on the particles of the blocks [first, last); of other particles it reads only what the stage does not write.
using StageFunction = void (*)(const StageData& data, std::size_t first, std::size_t last);

/// The stages of a step, compiled for one instruction set and one kernel.
struct ParticleStages {
    StageFunction drag;         ///< speed-dependent drag; only where there is any
    StageFunction evolve_soil;  ///< pore pressure and solid fraction; only where they evolve
    StageFunction predict;      ///< velocity and predicted position: work.predicted
    StageFunction begin;        ///< initialises work for all particles in their new order, sleeping ones included
    StageFunction pack_motion;  ///< positions and velocities in rows, for neighbours to read
    StageFunction resist;       ///< resistance of every particle; only where it varies between them
    StageFunction contacts;     ///< with ground and walls
    StageFunction resolve_penetration;
    StageFunction enforce_boundaries;
    /// Returns the largest speed, m/s; NaN where any is.
    float (*update_velocities)(const StageData& data, std::size_t first, std::size_t last);
    StageFunction apply_viscosity;
    StageFunction update_sleep;  ///< puts debris to sleep that has hardly moved, wakes debris beside moving debris
    std::string_view instruction_set;  ///< "AVX3", "AVX2", "SSE4", ...
};

/// The default method: density and internal friction as a stress per particle that persists between steps.
struct StressStages {
    StageFunction linearise;     ///< density constraints and pair gradients at the predicted positions; warm start
    StageFunction press_asleep;  ///< warm start of sleeping debris, which only presses on its neighbours
    StageFunction clear_asleep;  ///< sleeping debris contributes no further changes in this step
    StageFunction solve;         ///< eqs. (1) and (2), and the stress that resists the shear of this step
    StageFunction apply;         ///< eq. (3) with the full stress
    StageFunction find_spread;   ///< density above that at rest, as a multiplier
    StageFunction spread;        ///< the shift that reduces it
};

/// Pairwise position-based dynamics: density and pair friction, both start from zero in every step.
struct PairStages {
    StageFunction find_tolerated;      ///< compression at the step's start
    StageFunction update_multipliers;  ///< eqs. (1) and (2)
    StageFunction apply;               ///< eqs. (3) and (4)
};

/// The stages for a kernel and the chosen instruction set (dispatch.hpp).
[[nodiscard]] ParticleStages particle_stages_for(params::KernelChoice kernel);
[[nodiscard]] StressStages stress_stages_for(params::KernelChoice kernel);
[[nodiscard]] PairStages pair_stages_for(params::KernelChoice kernel);

}  // namespace talus::sim::cpu
