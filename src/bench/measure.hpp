#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/calibration.hpp"
#include "bench/scenes.hpp"
#include "core/result.hpp"
#include "params/spec.hpp"
#include "sim/stage_times.hpp"

namespace talus::bench {

/// Length of a measurement: repeats of some steps each. Absent values depend on the number of particles.
struct Length {
    int repeats = 7;
    std::optional<int> steps;    ///< per repeat
    std::optional<int> warm_up;  ///< steps before the first repeat
};

/// The measurement of one row of the table.
struct Task {
    params::InternalFriction method = params::InternalFriction::stress;
    int iterations = 4;
    int threads = 1;
    Length length;
    params::BackendChoice backend = params::BackendChoice::cpu;
};

/// Results of a measurement: medians over the repeats.
struct Row {
    std::string scene, method, instruction_set;
    std::string backend = "cpu";  ///< that took the steps, never "auto"
    std::uint32_t particles = 0;  ///< at the start
    int iterations = 0, threads = 0;
    int warm_up = 0, steps = 0, repeats = 0;  ///< steps per repeat

    std::array<double, sim::stage_count> stage_seconds{};  ///< per step
    double step_seconds = 0;
    double time_step = 0;  ///< s, mean of the measured steps
    bool fixed_time_step = false;
    double neighbours = 0;          ///< mean per particle, after the last step
    double bytes_per_particle = 0;  ///< allocated for it, on the card if one takes the steps; 0: not reported
    double calibration_rate = 0;    ///< units per second
    double mean_iterations = 0;     ///< that a step took: more than `iterations` where debris was overcompressed
    double relative_rate = 0;       ///< particle-iterations per calibration unit
    std::uint64_t hash = 0;         ///< of the state after the last step

    [[nodiscard]] double particle_iterations() const { return particles * mean_iterations; }
    [[nodiscard]] double particle_iterations_per_second() const { return particle_iterations() / step_seconds; }
    [[nodiscard]] double steps_per_second() const { return 1 / step_seconds; }
    [[nodiscard]] double real_time_factor() const { return time_step / step_seconds; }
};

/// "stress", "pair".
[[nodiscard]] std::string_view method_name(params::InternalFriction method);
[[nodiscard]] const std::vector<std::string>& method_names();
/// The method of one of these names.
[[nodiscard]] params::InternalFriction method_of(std::string_view name);

/// Default number of steps of a repeat, and before the first: the more particles, the fewer.
[[nodiscard]] int usual_steps(std::uint32_t particles);
[[nodiscard]] int usual_warm_up(std::uint32_t particles);

/// Runs steps of the scene, including all observation. Ends early, with an error, when `stop_requested`. Errors: a step
/// that cannot be trusted (the rate is then meaningless).
[[nodiscard]] Result<Row> measure(const Start& start, const Task& task, Calibration& calibration,
                                  const std::atomic<bool>* stop_requested = nullptr);

/// The middle one, or the mean of the two in the middle; 0 of none.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace talus::bench
