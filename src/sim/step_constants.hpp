#pragma once

#include "sim/model.hpp"
#include "sim/state.hpp"

namespace talus::sim {

/// The numbers that all particles of a step share, from the model and the length of the step: computed once, before the
/// first stage. In single precision, in which stages compute; the double-precision reference has its own.
struct StepConstants {
    StepConstants() = default;
    /// With the step's `time_step`, and the `previous_time_step` for which multipliers and stresses were computed.
    StepConstants(const Model& model, const StateSummary& state);

    float time_step{}, inverse_time_step{};
    float fall{};       ///< m/s, by gravity
    float max_shift{};  ///< m, the furthest that overlapping particles are moved apart

    // Density constraints.
    bool keeps_stress{};         ///< with internal friction as a stress; otherwise per pair
    float softness{};            ///< 1/m2, see gradient_square()
    float jacobi_factor{};       ///< see jacobi_factor()
    float warm_start_scale{};    ///< on multipliers and stresses of the last step: pressures times dt^2
    float pressure_scale{};      ///< on the same: pressure over density, m2/s2
    float spreading_share{};     ///< see spreading_share()
    float undone_compression{};  ///< with pair friction: of that at the step's start

    // Resistance.
    bool resists_by_particle{};   ///< see resists_by_particle()
    bool cohesive{};              ///< inside
    float strength_per_pascal{};  ///< m/Pa, see strength_per_pascal()
    float internal_strength{};    ///< see internal_strength()
    float inertial_grain_size{};  ///< m, see inertial_friction()
    float pair_friction_cap{};    ///< see pair_friction_cap()
    float viscous_smoothing{};    ///< see step_smoothing()
    bool water_rises{};           ///< in any release; see rising_water.hpp

    // Debris that sleeps.
    float rest_duration{};                ///< s
    float sleep_square{}, wake_square{};  ///< m2/s2, of speeds
};

}  // namespace talus::sim
