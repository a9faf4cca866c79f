#pragma once

#include <atomic>
#include <vector>

#include "core/result.hpp"
#include "scene/scene.hpp"

/// What a run costs on this machine, before it starts.
namespace talus::run {

/// A short run of a scene with few particles, from which the cost of the scene with more of them follows.
struct Rehearsal {
    struct Step {
        double max_speed;  ///< m/s, before the step
        double wall_time;  ///< s
    };
    double particle_spacing = 0;  ///< m
    std::vector<Step> steps;
    double simulated_time = 0;  ///< s
    bool complete = false;      ///< debris came to rest or solver.end_time was reached
    double many = 1;            ///< particles of the timed steps over those of the run
    double more_per_step = 1;   ///< time per step and particle of so many particles, relative to that of few
    double seeding_time = 0;    ///< s per particle
};

/// Runs the scene with 2000 particles for at most 8 s, and for a second with 20,000; with fewer where
/// `particle_spacing`, m, makes fewer. Errors: as Run::start().
[[nodiscard]] Result<Rehearsal> rehearse(const scene::Scene& scene, double particle_spacing,
                                         const std::atomic<bool>& stop_requested);

/// Estimates, within about a factor of two.
struct Cost {
    double particle_spacing = 0;               ///< m
    double particles = 0;                      ///< of all releases and inflows
    double simulated_time = 0, wall_time = 0;  ///< s; wall time of the steps alone, as in RunResult
    double seeding_time = 0;                   ///< s, before the first step
    double memory = 0;                         ///< bytes

    [[nodiscard]] double real_time_factor() const { return wall_time > 0 ? simulated_time / wall_time : 0; }
};

/// Of a run of the scene with particles of this spacing, m.
[[nodiscard]] Cost cost_of(const scene::Scene& scene, const Rehearsal& rehearsal, double particle_spacing);

/// What runs in real time is estimated to run so many times faster, since it is an estimate.
inline constexpr double real_time_margin = 1.5;

/// The most layers over `thickness`, m, that run in real time, to a tenth, within solver.particle_limit. Below 1: none.
[[nodiscard]] double real_time_layers(const scene::Scene& scene, const Rehearsal& rehearsal, double thickness);

}  // namespace talus::run
