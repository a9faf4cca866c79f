#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "sim/cpu/work.hpp"

namespace talus::cpu {

/// Works on the particles of the blocks [first, last); reads of others only what no stage of the same time writes.
using StageFunction = void (*)(const StageData& data, std::size_t first, std::size_t last);

/// The stages of a step, compiled for one instruction set and one kernel.
struct ParticleStages {
    StageFunction drag;         ///< what speed itself takes from velocities; only where there is such drag
    StageFunction predict;      ///< velocity, and the position that it leads to: work.predicted
    StageFunction begin;        ///< work as of the step's start, for particles in their new order, those asleep too
    StageFunction pack_motion;  ///< positions and velocities in rows, for neighbours to read
    StageFunction resist;       ///< how every particle is held; only where that differs between them
    StageFunction contacts;     ///< with ground and walls
    StageFunction undo_overlaps;
    StageFunction enforce_boundaries;
    /// Returns the largest speed, m/s; NaN where any is.
    float (*update_velocities)(const StageData& data, std::size_t first, std::size_t last);
    StageFunction apply_viscosity;
    StageFunction update_sleep;  ///< puts to sleep what has hardly moved for long, wakes what something moves beside
    std::string_view instruction_set;  ///< "AVX3", "AVX2", "SSE4", ...
};

/// The default method: density and internal friction as a stress per particle that persists between steps.
struct StressStages {
    StageFunction linearise;     ///< density constraints and pair gradients at the predicted positions; warm start
    StageFunction press_asleep;  ///< warm start of sleeping debris, which only presses on what lies beside it
    StageFunction clear_asleep;  ///< sleeping debris has no more to add in this step
    StageFunction solve;         ///< eqs. (1) and (2), and the stress that resists the shear of this step
    StageFunction apply;         ///< eq. (3) with the full stress
    StageFunction find_spread;   ///< what is denser than at rest, as a multiplier
    StageFunction spread;        ///< the shift that spreads it
};

/// Pairwise position-based dynamics: density and pair friction, both built up from nothing in every step.
struct PairStages {
    StageFunction find_tolerated;      ///< compression that the step starts with
    StageFunction update_multipliers;  ///< eqs. (1) and (2)
    StageFunction apply;               ///< eqs. (3) and (4)
};

/// The stages for a kernel on the instruction set that was chosen (dispatch.hpp).
[[nodiscard]] ParticleStages particle_stages_for(KernelChoice kernel);
[[nodiscard]] StressStages stress_stages_for(KernelChoice kernel);
[[nodiscard]] PairStages pair_stages_for(KernelChoice kernel);

}  // namespace talus::cpu
